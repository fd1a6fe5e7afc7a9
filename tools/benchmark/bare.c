/* The solve part by libraries alone: bare SYSTEM [METHOD...]

   SYSTEM is what bench_ours writes: K in coordinates, the rows N of the pairs, gaps, motions, loads, the pairs that touch and the
   displacements. Each method orders and factors K, makes F = N K^-1 N', solves for the forces of the touching pairs (given, not
   sought) and for the displacements; then seven times more with the same ordering. Prints for each method

       name; seconds of ordering, factor, F, contact, displacements; of all; of seven more; error of the displacements

   Times are of the processor, medians of as many runs as fit into a tenth of a second, the first of several left out. Three ways to F:
   "forward": X = L^-1 N' with all pairs at once, X'X. "last": the contact equations are ordered last, whose block of the factor
   alone gives F; MUMPS hands out its Schur complement instead. "entries": of the inverse, at the contact equations, by MUMPS.
   Without METHOD: all. */
#include <dmumps_c.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <time.h>

enum { ORDERING, FACTOR, FLEXIBILITY, CONTACT, DISPLACEMENTS, STAGES, ALL = STAGES, MORE, TIMES };
enum { MOST_RUNS = 200, FURTHER = 7 };
static const double LEAST_SECONDS = 0.1;

void dgemv_(const char *, const int *, const int *, const double *, const double *, const int *, const double *, const int *,
            const double *, double *, const int *);
void dpotrf_(const char *, const int *, double *, const int *, int *);
void dpotrs_(const char *, const int *, const int *, const double *, const int *, double *, const int *, int *);
void dsyrk_(const char *, const char *, const int *, const int *, const double *, const double *, const int *, const double *,
            double *, const int *);
void dtrsm_(const char *, const char *, const char *, const char *, const int *, const int *, const double *, const double *,
            const int *, double *, const int *);

typedef struct {
    int n, entries, pairs, row_entries, motions;
    int *row, *column;                          /* lower triangle, from 1; double ones add up */
    int *start, *equation, *touching;           /* rows of N, from 1 */
    double *value, *weight, *gap, *motion, *resultant, *load, *displacement;
    int contacts, *contact, *place;             /* equations in N, from 0; the place of each among them, or -1 */
} scene;

typedef struct {
    const char *name;
    int ordering;      /* CHOLMOD's, or MUMPS' ICNTL(7) */
    int supernodal;    /* CHOLMOD's; -1: MUMPS */
    int last;          /* contact equations last */
} method;

static const method METHODS[] = {
    {"CHOLMOD simplicial, AMD, forward", CHOLMOD_AMD, CHOLMOD_SIMPLICIAL, 0},
    {"CHOLMOD simplicial, CAMD, last", CHOLMOD_AMD, CHOLMOD_SIMPLICIAL, 1},
    {"CHOLMOD supernodal, AMD, forward", CHOLMOD_AMD, CHOLMOD_SUPERNODAL, 0},
    {"CHOLMOD supernodal, CAMD, last", CHOLMOD_AMD, CHOLMOD_SUPERNODAL, 1},
    {"CHOLMOD supernodal, METIS, forward", CHOLMOD_METIS, CHOLMOD_SUPERNODAL, 0},
    {"CHOLMOD supernodal, METIS, last", CHOLMOD_METIS, CHOLMOD_SUPERNODAL, 1},
    {"CHOLMOD supernodal, NESDIS, forward", CHOLMOD_NESDIS, CHOLMOD_SUPERNODAL, 0},
    {"MUMPS, AMD, last", 0, -1, 1},   /* its Schur complement has this ordering alone */
    {"MUMPS, AMF, entries", 2, -1, 0},
    {"MUMPS, SCOTCH, entries", 3, -1, 0},
    {"MUMPS, PORD, entries", 4, -1, 0},
    {"MUMPS, QAMD, entries", 6, -1, 0},
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

static void fail(const char *what) {
    fprintf(stderr, "bare: %s\n", what);
    exit(1);
}

static void *room(size_t count, size_t size) {
    void *p = calloc(count ? count : 1, size);
    if (!p) fail("no memory");
    return p;
}

static void *take(FILE *file, size_t count, size_t size) {
    void *p = room(count, size);
    if (fread(p, size, count, file) != count) fail("the system is too short");
    return p;
}

static scene read_scene(const char *path) {
    scene s;
    FILE *file = fopen(path, "rb");
    if (!file) fail("no such system");
    int *head = take(file, 5, sizeof(int));
    s.n = head[0], s.entries = head[1], s.pairs = head[2], s.row_entries = head[3], s.motions = head[4];
    free(head);
    s.row = take(file, s.entries, sizeof(int));
    s.column = take(file, s.entries, sizeof(int));
    s.value = take(file, s.entries, sizeof(double));
    s.start = take(file, s.pairs + 1, sizeof(int));
    s.equation = take(file, s.row_entries, sizeof(int));
    s.weight = take(file, s.row_entries, sizeof(double));
    s.gap = take(file, s.pairs, sizeof(double));
    s.motion = take(file, (size_t)s.pairs * s.motions, sizeof(double));
    s.resultant = take(file, s.motions, sizeof(double));
    s.touching = take(file, s.pairs, sizeof(int));
    s.load = take(file, s.n, sizeof(double));
    s.displacement = take(file, s.n, sizeof(double));
    fclose(file);
    s.contacts = 0;
    s.contact = room(s.n, sizeof(int));
    s.place = room(s.n, sizeof(int));
    for (int i = 0; i < s.row_entries; i++) s.place[s.equation[i] - 1] = 1;
    for (int i = 0; i < s.n; i++)
        if (s.place[i]) s.contact[s.contacts] = i, s.place[i] = s.contacts++;
        else s.place[i] = -1;
    return s;
}

/* F = X'X with X = L^-1 N', L the factor of the contacts' complement [contacts, contacts], its rows by `at`. */
static void square(const scene *s, const double *factor, const int *at, double *flexibility) {
    const double one = 1.0, none = 0.0;
    double *x = room((size_t)s->contacts * s->pairs, sizeof(double));
    for (int k = 0; k < s->pairs; k++)
        for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++)
            x[(size_t)k * s->contacts + at[s->place[s->equation[i] - 1]]] += s->weight[i];
    dtrsm_("L", "L", "N", "N", &s->contacts, &s->pairs, &one, factor, &s->contacts, x, &s->contacts);
    dsyrk_("L", "T", &s->pairs, &s->contacts, &one, x, &s->contacts, &none, flexibility, &s->pairs);
    free(x);
}

/* Forces of the pairs that touch: F R - A q = -gap there, A'R = P. */
static void solve_contact(const scene *s, const double *flexibility, double *force) {
    int active = 0, info = 0, m = s->motions, right = m + 1, single = 1;
    int *pair = room(s->pairs, sizeof(int));
    for (int k = 0; k < s->pairs; k++)
        if (s->touching[k]) pair[active++] = k;
    double *f = room((size_t)active * active, sizeof(double)), *x = room((size_t)active * right, sizeof(double));
    double *reduced = room((size_t)m * m, sizeof(double)), *q = room(m, sizeof(double));
    for (int j = 0; j < active; j++)
        for (int i = j; i < active; i++) f[(size_t)j * active + i] = flexibility[(size_t)pair[j] * s->pairs + pair[i]];
    for (int i = 0; i < active; i++) {
        for (int j = 0; j < m; j++) x[(size_t)j * active + i] = s->motion[(size_t)j * s->pairs + pair[i]];
        x[(size_t)m * active + i] = s->gap[pair[i]];
    }
    dpotrf_("L", &active, f, &active, &info);
    if (!info) dpotrs_("L", &active, &right, f, &active, x, &active, &info);
    for (int j = 0; j < m; j++) {
        q[j] = s->resultant[j];
        for (int i = 0; i < active; i++) {
            const double a = s->motion[(size_t)j * s->pairs + pair[i]];
            q[j] += a * x[(size_t)m * active + i];
            for (int l = 0; l < m; l++) reduced[j * m + l] += a * x[(size_t)l * active + i];
        }
    }
    if (!info && m) dpotrf_("L", &m, reduced, &m, &info);
    if (!info && m) dpotrs_("L", &m, &single, reduced, &m, q, &m, &info);
    if (info) fail("the contact problem was not solved");
    memset(force, 0, s->pairs * sizeof(double));
    for (int i = 0; i < active; i++) {
        force[pair[i]] = -x[(size_t)m * active + i];
        for (int j = 0; j < m; j++) force[pair[i]] += x[(size_t)j * active + i] * q[j];
    }
    free(pair), free(f), free(x), free(reduced), free(q);
}

/* x = f + N'R. */
static void add_forces(const scene *s, const double *force, double *x) {
    memcpy(x, s->load, s->n * sizeof(double));
    for (int k = 0; k < s->pairs; k++)
        for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++) x[s->equation[i] - 1] += force[k] * s->weight[i];
}

static double error_of(const scene *s, const double *x) {
    double off = 0.0, largest = 0.0;
    for (int i = 0; i < s->n; i++) {
        off = fmax(off, fabs(x[i] - s->displacement[i]));
        largest = fmax(largest, fabs(s->displacement[i]));
    }
    return off / largest;
}

/* ---- CHOLMOD ---- */

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

/* Order and analyse; with the contact equations last where asked for. */
static cholmod_factor *analyse(const scene *s, const method *way, cholmod_sparse *k, cholmod_common *c) {
    c->supernodal = way->supernodal;
    c->final_ll = 1;
    c->nmethods = 1;
    c->method[0].ordering = way->last ? CHOLMOD_GIVEN : way->ordering;
    if (!way->last) return cholmod_analyze(k, c);
    int *order = room(s->n, sizeof(int)), *member = room(s->n, sizeof(int)), *found = room(s->n, sizeof(int));
    if (way->ordering == CHOLMOD_AMD) {
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

/* Block of the factor that the contact equations alone have, and where each stands in it. Nothing else follows them in the
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

static void cholmod_flexibility(const scene *s, const method *way, cholmod_factor *l, double *flexibility, cholmod_common *c) {
    if (way->last) {
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

/* Factor, F, contact, displacements: their times and the error. */
static double cholmod_again(const scene *s, const method *way, cholmod_sparse *k, cholmod_factor *l, double *flexibility,
                            double *spent, cholmod_common *c) {
    double *force = room(s->pairs, sizeof(double)), begun = now(), error;
    cholmod_factorize(k, l, c);
    if (c->status != CHOLMOD_OK) fail("CHOLMOD did not factor");
    spent[FACTOR] = now() - begun, begun = now();
    cholmod_flexibility(s, way, l, flexibility, c);
    spent[FLEXIBILITY] = now() - begun, begun = now();
    solve_contact(s, flexibility, force);
    spent[CONTACT] = now() - begun, begun = now();
    cholmod_dense *x = cholmod_allocate_dense(s->n, 1, s->n, CHOLMOD_REAL, c);
    add_forces(s, force, x->x);
    cholmod_dense *u = cholmod_solve(CHOLMOD_A, l, x, c);
    spent[DISPLACEMENTS] = now() - begun;
    error = error_of(s, u->x);
    cholmod_free_dense(&x, c), cholmod_free_dense(&u, c), free(force);
    return error;
}

static double by_cholmod(const scene *s, const method *way, double *spent, double *more) {
    cholmod_common c;
    cholmod_start(&c);
    cholmod_sparse *k = compressed(s, &c);
    double *flexibility = room((size_t)s->pairs * s->pairs, sizeof(double)), begun = now(), again[STAGES];
    cholmod_factor *l = analyse(s, way, k, &c);
    spent[ORDERING] = now() - begun;
    double error = cholmod_again(s, way, k, l, flexibility, spent, &c);
    *more = 0.0;
    for (int i = 0; i < FURTHER; i++) {
        cholmod_again(s, way, k, l, flexibility, again, &c);
        for (int j = FACTOR; j < STAGES; j++) *more += again[j];
    }
    cholmod_free_factor(&l, &c), cholmod_free_sparse(&k, &c), cholmod_finish(&c), free(flexibility);
    return error;
}

/* ---- MUMPS ---- */

static void mumps(DMUMPS_STRUC_C *id, int job) {
    id->job = job;
    dmumps_c(id);
    if (id->infog[0] < 0) fail("MUMPS failed");
}

/* F from the Schur complement of the contact equations; it is left factored. */
static void from_complement(const scene *s, DMUMPS_STRUC_C *id, double *flexibility) {
    const int c = s->contacts;
    int *at = room(c, sizeof(int)), info = 0;
    for (int i = 0; i < c; i++) {
        at[i] = i;
        for (int j = 0; j < i; j++) id->schur[(size_t)j * c + i] = id->schur[(size_t)i * c + j]; /* it comes by rows */
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

/* Factor, F, contact, displacements: their times and the error. */
static double mumps_again(const scene *s, const method *way, DMUMPS_STRUC_C *id, double *flexibility, double *spent) {
    double *force = room(s->pairs, sizeof(double)), *x = room(s->n, sizeof(double)), *left = room(s->contacts, sizeof(double));
    double begun = now(), error;
    int info = 0, single = 1;
    mumps(id, 2);
    spent[FACTOR] = now() - begun, begun = now();
    (way->last ? from_complement : from_entries)(s, id, flexibility);
    spent[FLEXIBILITY] = now() - begun, begun = now();
    solve_contact(s, flexibility, force);
    spent[CONTACT] = now() - begun, begun = now();
    add_forces(s, force, x);
    id->rhs = x, id->redrhs = left, id->nrhs = 1, id->lrhs = s->n, id->lredrhs = s->contacts;
    id->icntl[25] = way->last;
    mumps(id, 3);
    if (way->last) {
        dpotrs_("L", &s->contacts, &single, id->schur, &s->contacts, left, &s->contacts, &info);
        id->icntl[25] = 2;
        mumps(id, 3);
    }
    spent[DISPLACEMENTS] = now() - begun;
    error = error_of(s, x);
    free(force), free(x), free(left);
    return error;
}

static double by_mumps(const scene *s, const method *way, double *spent, double *more) {
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
    id.icntl[6] = way->ordering;
    if (way->last) {
        id.icntl[18] = 1, id.size_schur = s->contacts, id.listvar_schur = list;
        id.schur = room((size_t)s->contacts * s->contacts, sizeof(double));
    }
    mumps(&id, 1);
    spent[ORDERING] = now() - begun;
    double error = mumps_again(s, way, &id, flexibility, spent);
    *more = 0.0;
    for (int i = 0; i < FURTHER; i++) {
        mumps_again(s, way, &id, flexibility, again);
        for (int j = FACTOR; j < STAGES; j++) *more += again[j];
    }
    mumps(&id, -2);
    free(id.schur), free(list), free(flexibility);
    return error;
}

/* ---- */

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count) {
    qsort(values, count, sizeof(double), ascending);
    return values[(count - 1) / 2];
}

static void run(const scene *s, const method *way) {
    static double seconds[TIMES][MOST_RUNS];
    double spent[TIMES], total = 0.0, error = 0.0;
    int runs = 0;
    while (runs < MOST_RUNS && (!runs || total < LEAST_SECONDS)) {
        error = (way->supernodal < 0 ? by_mumps : by_cholmod)(s, way, spent, &spent[MORE]);
        spent[ALL] = 0.0;
        for (int i = 0; i < STAGES; i++) spent[ALL] += spent[i];
        for (int i = 0; i < TIMES; i++) seconds[i][runs] = spent[i];
        total += spent[ALL] + spent[MORE];
        runs++;
    }
    printf("%s", way->name);
    for (int i = 0; i < TIMES; i++) printf("; %.4e", median(seconds[i] + (runs > 1), runs - (runs > 1)));
    printf("; %.1e\n", error);
    fflush(stdout);
}

int main(int count, char **word) {
    if (count < 2) fail("bare SYSTEM [METHOD...]");
    const scene s = read_scene(word[1]);
    for (size_t i = 0; i < sizeof METHODS / sizeof *METHODS; i++) {
        int wanted = count == 2;
        for (int k = 2; k < count; k++) wanted |= !strcmp(word[k], METHODS[i].name);
        if (wanted) run(&s, &METHODS[i]);
    }
    return 0;
}
