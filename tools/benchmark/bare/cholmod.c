/* CHOLMOD, simplicial or supernodal, with several orderings. */
#include "bare.h"
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

static cholmod_sparse *compressed(const scene *s, cholmod_common *c) {
    cholmod_triplet *t = cholmod_allocate_triplet(s->n, s->n, s->entries, -1, CHOLMOD_REAL, c);
    for (int i = 0; i < s->entries; i++) {
        ((int *)t->i)[i] = s->row[i] - 1;
        ((int *)t->j)[i] = s->column[i] - 1;
        ((double *)t->x)[i] = s->value[i];
    }
    t->nnz = s->entries;
    cholmod_sparse *k = cholmod_triplet_to_sparse(t, s->entries, c);
    cholmod_free_triplet(&t, c);
    return k;
}

/* Order and analyse; with the contact equations last on request. */
static cholmod_factor *analyse(const scene *s, int ordering, int kind, int last, cholmod_sparse *k, cholmod_common *c) {
    c->supernodal = kind;
    c->final_ll = 1;
    c->nmethods = 1;
    c->method[0].ordering = last ? CHOLMOD_GIVEN : ordering;
    if (!last) return cholmod_analyze(k, c);
    int *order = room(s->n, sizeof(int)), *member = room(s->n, sizeof(int)), *found = room(s->n, sizeof(int));
    if (ordering == CHOLMOD_AMD) {
        for (int i = 0; i < s->n; i++) member[i] = s->place[i] >= 0;
        cholmod_camd(k, NULL, 0, member, order, c);
    } else {
        int filled = 0;
        cholmod_metis(k, NULL, 0, 1, found, c);
        for (int group = 0; group < 2; group++)
            for (int i = 0; i < s->n; i++)
                if ((s->place[found[i]] >= 0) == group) order[filled++] = found[i];
    }
    cholmod_factor *factor = cholmod_analyze_p(k, order, NULL, 0, c);
    free(order), free(member), free(found);
    return factor;
}

/* Block of the factor for the contact equations only, and the position of each in it. Nothing else follows them in the
   elimination tree, whatever it was postordered to. */
static void take_block(const scene *s, const cholmod_factor *l, double *block, int *at) {
    const int *order = l->Perm;
    int *place = room(s->n, sizeof(int)), count = 0;
    for (int i = 0; i < s->n; i++) {
        place[i] = s->place[order[i]] >= 0 ? count : -1;
        if (place[i] >= 0) at[s->place[order[i]]] = count++;
    }
    if (l->is_super) {
        const int *super = l->super, *pi = l->pi, *px = l->px, *rows = l->s;
        for (int k = l->nsuper - 1, left = count; k >= 0 && left > 0; k--) {
            const int height = pi[k + 1] - pi[k];
            for (int j = super[k]; j < super[k + 1]; j++) {
                if (place[j] < 0) continue;
                left--;
                for (int i = j - super[k]; i < height; i++)
                    block[(size_t)place[j] * count + place[rows[pi[k] + i]]] = ((double *)l->x)[px[k] + (size_t)(j - super[k]) * height + i];
            }
        }
    } else {
        const int *p = l->p, *rows = l->i, *number = l->nz;
        for (int j = 0; j < s->n; j++)
            for (int i = p[j]; place[j] >= 0 && i < p[j] + number[j]; i++)
                block[(size_t)place[j] * count + place[rows[i]]] = ((double *)l->x)[i];
    }
    free(place);
}

static void cholmod_flexibility(const scene *s, int last, cholmod_factor *l, double *flexibility, cholmod_common *c) {
    if (last) {
        double *block = room((size_t)s->contacts * s->contacts, sizeof(double));
        int *at = room(s->contacts, sizeof(int));
        take_block(s, l, block, at);
        square(s, block, at, flexibility);
        free(block), free(at);
        return;
    }
    const double one = 1.0, none = 0.0;
    const int *order = l->Perm;
    int *place = room(s->n, sizeof(int));
    for (int i = 0; i < s->n; i++) place[order[i]] = i;
    cholmod_dense *x = cholmod_zeros(s->n, s->pairs, CHOLMOD_REAL, c);
    for (int k = 0; k < s->pairs; k++)
        for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++)
            ((double *)x->x)[(size_t)k * s->n + place[s->equation[i] - 1]] += s->weight[i];
    cholmod_dense *y = cholmod_solve(CHOLMOD_L, l, x, c);
    dsyrk_("L", "T", &s->pairs, &s->n, &one, y->x, &s->n, &none, flexibility, &s->pairs);
    cholmod_free_dense(&x, c), cholmod_free_dense(&y, c), free(place);
}

/* Right-hand side of the given displacements. */
static void multiply(const scene *s, cholmod_sparse *k, cholmod_dense *x, cholmod_common *c) {
    double one[2] = {1.0, 0.0}, none[2] = {0.0, 0.0};
    cholmod_dense *u = cholmod_allocate_dense(s->n, 1, s->n, CHOLMOD_REAL, c);
    memcpy(u->x, s->displacement, s->n * sizeof(double));
    cholmod_sdmult(k, 0, one, none, u, x, c);
    cholmod_free_dense(&u, c);
}

/* Times of factor, F, contact and displacements, and the error. */
static double cholmod_again(const scene *s, int last, cholmod_sparse *k, cholmod_factor *l, double *flexibility,
                            double *spent, cholmod_common *c) {
    double *force = room(s->pairs, sizeof(double)), begun = now(), error;
    cholmod_factorize(k, l, c);
    if (c->status != CHOLMOD_OK) fail("CHOLMOD did not factor");
    spent[FACTOR] = now() - begun, begun = now();
    if (!s->solves) cholmod_flexibility(s, last, l, flexibility, c);
    spent[FLEXIBILITY] = now() - begun, begun = now();
    if (!s->solves) solve_contact(s, flexibility, force);
    spent[CONTACT] = now() - begun, begun = now();
    cholmod_dense *x = cholmod_allocate_dense(s->n, 1, s->n, CHOLMOD_REAL, c);
    if (s->solves) multiply(s, k, x, c), begun = now();
    else add_forces(s, force, x->x);
    cholmod_dense *u = cholmod_solve(CHOLMOD_A, l, x, c);
    spent[DISPLACEMENTS] = now() - begun;
    error = error_of(s, u->x);
    cholmod_free_dense(&x, c), cholmod_free_dense(&u, c), free(force);
    return error;
}

double by_cholmod(const scene *s, int ordering, int kind, int last, double *spent, double *more) {
    cholmod_common c;
    cholmod_start(&c);
    cholmod_sparse *k = compressed(s, &c);
    double *flexibility = room((size_t)s->pairs * s->pairs, sizeof(double)), begun = now(), again[STAGES];
    cholmod_factor *l = analyse(s, ordering, kind, last, k, &c);
    spent[ORDERING] = now() - begun;
    double error = cholmod_again(s, last, k, l, flexibility, spent, &c);
    *more = 0.0;
    for (int i = 0; i < FURTHER && !s->solves; i++) {
        cholmod_again(s, last, k, l, flexibility, again, &c);
        for (int j = FACTOR; j < STAGES; j++) *more += again[j];
    }
    cholmod_free_factor(&l, &c), cholmod_free_sparse(&k, &c), cholmod_finish(&c), free(flexibility);
    return error;
}
