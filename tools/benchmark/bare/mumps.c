/* MUMPS without MPI: F by its Schur complement, or by entries of the inverse. */
#include "bare.h"
#include <dmumps_c.h>
#include <stdlib.h>
#include <string.h>

static void mumps(DMUMPS_STRUC_C *id, int job) {
    id->job = job;
    dmumps_c(id);
    if (id->infog[0] < 0) fail("MUMPS failed");
}

/* F from the Schur complement of the contact equations, which stays factored. */
static void from_complement(const scene *s, DMUMPS_STRUC_C *id, double *flexibility) {
    const int c = s->contacts;
    int *at = room(c, sizeof(int)), info = 0;
    for (int i = 0; i < c; i++) {
        at[i] = i;
        for (int j = 0; j < i; j++) id->schur[(size_t)j * c + i] = id->schur[(size_t)i * c + j]; /* stored by rows */
    }
    dpotrf_("L", &c, id->schur, &c, &info);
    if (info) fail("MUMPS' complement is not definite");
    square(s, id->schur, at, flexibility);
    free(at);
}

/* F from the entries of the inverse at the contact equations. */
static void from_entries(const scene *s, DMUMPS_STRUC_C *id, double *flexibility) {
    const int c = s->contacts;
    int *first = room(s->n + 1, sizeof(int)), *row = room((size_t)c * c, sizeof(int)), filled = 0;
    double *inverse = room((size_t)c * c, sizeof(double)), *full = room((size_t)c * c, sizeof(double));
    for (int i = 0; i < s->n; i++) {
        first[i] = filled + 1;
        for (int j = s->place[i]; j >= 0 && j < c; j++) row[filled++] = s->contact[j] + 1;
    }
    first[s->n] = filled + 1;
    id->irhs_ptr = first, id->irhs_sparse = row, id->rhs_sparse = inverse, id->nz_rhs = filled, id->nrhs = s->n;
    id->icntl[26] = 64;
    id->icntl[29] = 1;
    mumps(id, 3);
    id->icntl[29] = 0;
    for (int i = 0, k = 0; i < c; i++)
        for (int j = i; j < c; j++) full[(size_t)i * c + j] = full[(size_t)j * c + i] = inverse[k++];
    for (int k = 0; k < s->pairs; k++)
        for (int l = 0; l < s->pairs; l++) {
            double sum = 0.0;
            for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++)
                for (int j = s->start[l] - 1; j < s->start[l + 1] - 1; j++)
                    sum += s->weight[i] * s->weight[j] * full[(size_t)s->place[s->equation[i] - 1] * c + s->place[s->equation[j] - 1]];
            flexibility[(size_t)k * s->pairs + l] = sum;
        }
    free(first), free(row), free(inverse), free(full);
}

/* Times of factor, F, contact and displacements, and the error. */
static double mumps_again(const scene *s, int last, DMUMPS_STRUC_C *id, double *flexibility, double *spent) {
    double *force = room(s->pairs, sizeof(double)), *x = room(s->n, sizeof(double)), *left = room(s->contacts, sizeof(double));
    double begun = now(), error;
    int info = 0, single = 1;
    mumps(id, 2);
    spent[FACTOR] = now() - begun, begun = now();
    (last ? from_complement : from_entries)(s, id, flexibility);
    spent[FLEXIBILITY] = now() - begun, begun = now();
    solve_contact(s, flexibility, force);
    spent[CONTACT] = now() - begun, begun = now();
    add_forces(s, force, x);
    id->rhs = x, id->redrhs = left, id->nrhs = 1, id->lrhs = s->n, id->lredrhs = s->contacts;
    id->icntl[25] = last;
    mumps(id, 3);
    if (last) {
        dpotrs_("L", &s->contacts, &single, id->schur, &s->contacts, left, &s->contacts, &info);
        id->icntl[25] = 2;
        mumps(id, 3);
    }
    spent[DISPLACEMENTS] = now() - begun;
    error = error_of(s, x);
    free(force), free(x), free(left);
    return error;
}

double by_mumps(const scene *s, int ordering, int kind, int last, double *spent, double *more) {
    (void)kind;
    DMUMPS_STRUC_C id;
    double *flexibility = room((size_t)s->pairs * s->pairs, sizeof(double)), again[STAGES];
    int *list = room(s->contacts, sizeof(int));
    memset(&id, 0, sizeof id);
    double begun = now();
    id.par = 1, id.sym = 1, id.comm_fortran = -987654;
    mumps(&id, -1);
    for (int i = 0; i < 3; i++) id.icntl[i] = -1;
    id.icntl[3] = 0;
    for (int i = 0; i < s->contacts; i++) list[i] = s->contact[i] + 1;
    id.n = s->n, id.nnz = s->entries, id.irn = s->row, id.jcn = s->column, id.a = s->value;
    id.icntl[6] = ordering;
    if (last) {
        id.icntl[18] = 1, id.size_schur = s->contacts, id.listvar_schur = list;
        id.schur = room((size_t)s->contacts * s->contacts, sizeof(double));
    }
    mumps(&id, 1);
    spent[ORDERING] = now() - begun;
    double error = mumps_again(s, last, &id, flexibility, spent);
    *more = 0.0;
    for (int i = 0; i < FURTHER; i++) {
        mumps_again(s, last, &id, flexibility, again);
        for (int j = FACTOR; j < STAGES; j++) *more += again[j];
    }
    mumps(&id, -2);
    free(id.schur), free(list), free(flexibility);
    return error;
}
