/* The solver with libraries only: bench_bare SYSTEM [--solves] [METHOD...]

   SYSTEM is what bench_ours writes: K in coordinates, the rows N of the pairs, gaps, motions, loads, the pairs that touch and the
   displacements. Each method orders and factors K, makes F = N K^-1 N', solves for the forces of the touching pairs (given, not
   sought) and for the displacements; then seven times more with the same ordering. Prints for each method

       name; seconds of ordering, factor, F, contact, displacements; of all; of seven more; error of the displacements

   Times are of the processor, medians of as many runs as fit into three tenths of a second, the first of several left out. Filling in
   the matrix is not timed. Three ways to F: "forward": X = L^-1 N', X'X; "last": the contact equations are ordered last, whose block
   of the factor alone gives F (MUMPS hands out its Schur complement instead); "entries": of the inverse, at the contact equations,
   by MUMPS. Without METHOD: all. With --solves, by CHOLMOD: ordering, one factor, and one solve for the displacements, nothing else;
   of many pairs F by "forward" takes minutes. */
#include "bare.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <time.h>

enum { ALL = STAGES, MORE, TIMES };
enum { MOST_RUNS = 200 };
static const double LEAST_SECONDS = 0.3;

static const method METHODS[] = {
    {"LAPACK band, RCM, forward", by_band, 0, 0, 0},
    {"LAPACK band, RCM, last", by_band, 0, 0, 1},
    {"CHOLMOD simplicial, AMD, forward", by_cholmod, CHOLMOD_AMD, CHOLMOD_SIMPLICIAL, 0},
    {"CHOLMOD simplicial, CAMD, last", by_cholmod, CHOLMOD_AMD, CHOLMOD_SIMPLICIAL, 1},
    {"CHOLMOD supernodal, AMD, forward", by_cholmod, CHOLMOD_AMD, CHOLMOD_SUPERNODAL, 0},
    {"CHOLMOD supernodal, CAMD, last", by_cholmod, CHOLMOD_AMD, CHOLMOD_SUPERNODAL, 1},
    {"CHOLMOD supernodal, METIS, forward", by_cholmod, CHOLMOD_METIS, CHOLMOD_SUPERNODAL, 0},
    {"CHOLMOD supernodal, METIS, last", by_cholmod, CHOLMOD_METIS, CHOLMOD_SUPERNODAL, 1},
    {"CHOLMOD supernodal, NESDIS, forward", by_cholmod, CHOLMOD_NESDIS, CHOLMOD_SUPERNODAL, 0},
    {"MUMPS, AMD, last", by_mumps, 0, 0, 1},    /* its Schur complement has only this ordering */
    {"MUMPS, AMF, entries", by_mumps, 2, 0, 0},
    {"MUMPS, SCOTCH, entries", by_mumps, 3, 0, 0},
    {"MUMPS, PORD, entries", by_mumps, 4, 0, 0},
    {"MUMPS, QAMD, entries", by_mumps, 6, 0, 0},
};

double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

void fail(const char *what) {
    fprintf(stderr, "bench_bare: %s\n", what);
    exit(1);
}

void *room(size_t count, size_t size) {
    void *p = calloc(count ? count : 1, size);
    if (!p) fail("no memory");
    return p;
}

static void *take(FILE *file, size_t count, size_t size) {
    void *p = room(count, size);
    if (fread(p, size, count, file) != count) fail("the system is too short");
    return p;
}

/* Add up entries of the same position; sort them by columns, and within these by rows. */
static void compress(scene *s) {
    int *begin = room(s->n + 2, sizeof(int)), *row = room(s->entries, sizeof(int)), filled = 0;
    double *value = room(s->entries, sizeof(double));
    for (int e = 0; e < s->entries; e++) begin[s->column[e] + 1]++;
    for (int j = 0; j <= s->n; j++) begin[j + 1] += begin[j];
    for (int e = 0; e < s->entries; e++) {
        const int to = begin[s->column[e]]++;
        row[to] = s->row[e], value[to] = s->value[e];
    }
    for (int j = 1, e = 0; j <= s->n; j++) {
        for (const int from = filled; e < begin[j]; e++) {
            int to = filled;
            while (to > from && s->row[to - 1] > row[e]) to--;
            if (to > from && s->row[to - 1] == row[e]) {
                s->value[to - 1] += value[e];
                continue;
            }
            memmove(s->row + to + 1, s->row + to, (filled - to) * sizeof(int));
            memmove(s->value + to + 1, s->value + to, (filled - to) * sizeof(double));
            s->row[to] = row[e], s->value[to] = value[e], s->column[filled++] = j;
        }
    }
    s->entries = filled;
    free(begin), free(row), free(value);
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
    compress(&s);
    s.contacts = 0;
    s.contact = room(s.n, sizeof(int));
    s.place = room(s.n, sizeof(int));
    for (int i = 0; i < s.row_entries; i++) s.place[s.equation[i] - 1] = 1;
    for (int i = 0; i < s.n; i++)
        if (s.place[i]) s.contact[s.contacts] = i, s.place[i] = s.contacts++;
        else s.place[i] = -1;
    return s;
}

void square(const scene *s, const double *factor, const int *at, double *flexibility) {
    const double one = 1.0, none = 0.0;
    double *x = room((size_t)s->contacts * s->pairs, sizeof(double));
    for (int k = 0; k < s->pairs; k++)
        for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++)
            x[(size_t)k * s->contacts + at[s->place[s->equation[i] - 1]]] += s->weight[i];
    dtrsm_("L", "L", "N", "N", &s->contacts, &s->pairs, &one, factor, &s->contacts, x, &s->contacts);
    dsyrk_("L", "T", &s->pairs, &s->contacts, &one, x, &s->contacts, &none, flexibility, &s->pairs);
    free(x);
}

void solve_contact(const scene *s, const double *flexibility, double *force) {
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

void add_forces(const scene *s, const double *force, double *x) {
    memcpy(x, s->load, s->n * sizeof(double));
    for (int k = 0; k < s->pairs; k++)
        for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++) x[s->equation[i] - 1] += force[k] * s->weight[i];
}

double error_of(const scene *s, const double *x) {
    double off = 0.0, largest = 0.0;
    for (int i = 0; i < s->n; i++) {
        off = fmax(off, fabs(x[i] - s->displacement[i]));
        largest = fmax(largest, fabs(s->displacement[i]));
    }
    return off / largest;
}

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
        error = way->run(s, way->ordering, way->kind, way->last, spent, &spent[MORE]);
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
    if (count < 2) fail("bench_bare SYSTEM [--solves] [METHOD...]");
    scene s = read_scene(word[1]);
    s.solves = count > 2 && !strcmp(word[2], "--solves");
    for (size_t i = 0; i < sizeof METHODS / sizeof *METHODS; i++) {
        int wanted = count == 2 + s.solves;
        for (int k = 2 + s.solves; k < count; k++) wanted |= !strcmp(word[k], METHODS[i].name);
        if (wanted) run(&s, &METHODS[i]);
    }
    return 0;
}
