/* LAPACK's band, with reverse Cuthill-McKee: the root is at the contact equations, so that they come last, or at a far end. */
#include "bare.h"
#include <stdlib.h>
#include <string.h>

/* Neighbours of equation i: next[first[i]] to next[first[i + 1] - 1]. */
typedef struct {
    int *first, *next;
} graph;

static graph graph_of(const scene *s) {
    graph g = {room(s->n + 1, sizeof(int)), room(2 * (size_t)s->entries, sizeof(int))};
    int *fill = room(s->n + 1, sizeof(int));
    for (int e = 0; e < s->entries; e++)
        if (s->row[e] != s->column[e]) g.first[s->row[e]]++, g.first[s->column[e]]++;
    for (int i = 0; i < s->n; i++) g.first[i + 1] += g.first[i];
    memcpy(fill, g.first, s->n * sizeof(int));
    for (int e = 0; e < s->entries; e++) {
        const int i = s->row[e] - 1, j = s->column[e] - 1;
        if (i != j) g.next[fill[i]++] = j, g.next[fill[j]++] = i;
    }
    free(fill);
    return g;
}

/* Breadth-first search from the first `filled` of `order`; the new neighbours of each equation are sorted by their number of neighbours. */
static void sweep(const graph *g, int n, int filled, int *order) {
    char *seen = room(n, 1);
    for (int i = 0; i < filled; i++) seen[order[i]] = 1;
    for (int at = 0, other = 0; at < n; at++) {
        if (at == filled) {    /* another body */
            while (seen[other]) other++;
            seen[order[filled++] = other] = 1;
        }
        const int begin = filled;
        for (int k = g->first[order[at]]; k < g->first[order[at] + 1]; k++) {
            const int i = g->next[k], degree = g->first[i + 1] - g->first[i];
            if (seen[i]) continue;
            seen[i] = 1;
            int to = filled++;
            for (; to > begin && g->first[order[to - 1] + 1] - g->first[order[to - 1]] > degree; to--) order[to] = order[to - 1];
            order[to] = i;
        }
    }
    free(seen);
}

/* Compute the position of each equation; return the half-bandwidth. */
static int number(const scene *s, int last, int *place) {
    graph g = graph_of(s);
    int *order = room(s->n, sizeof(int)), width = 0;
    for (int k = 0; k < 3; k++) {
        order[0] = order[k ? s->n - 1 : 0];
        sweep(&g, s->n, 1, order);
    }
    if (last) {    /* the roots keep their order of the sweep from the far end, along the contact */
        int roots = 0;
        for (int i = 0; i < s->n; i++)
            if (s->place[order[i]] >= 0) order[roots++] = order[i];
        sweep(&g, s->n, roots, order);
    }
    for (int i = 0; i < s->n; i++) place[order[i]] = s->n - 1 - i;
    for (int e = 0; e < s->entries; e++) {
        const int apart = abs(place[s->row[e] - 1] - place[s->column[e] - 1]);
        if (apart > width) width = apart;
    }
    free(order), free(g.first), free(g.next);
    return width;
}

/* F from the last block of the factor. */
static void from_block(const scene *s, int width, const double *band, const int *place, double *flexibility) {
    const int c = s->contacts, before = s->n - c;
    double *block = room((size_t)c * c, sizeof(double));
    int *at = room(c, sizeof(int));
    for (int j = 0; j < c; j++) {
        at[j] = place[s->contact[j]] - before;
        for (int i = j; i < c && i - j <= width; i++) block[(size_t)j * c + i] = band[(size_t)(before + j) * (width + 1) + i - j];
    }
    square(s, block, at, flexibility);
    free(block), free(at);
}

/* F from X = L^-1 N'; each column begins at its first entry. */
static void from_columns(const scene *s, int width, const double *band, const int *place, double *flexibility) {
    const double one = 1.0, none = 0.0;
    const int height = width + 1, single = 1;
    double *x = room((size_t)s->n * s->pairs, sizeof(double));
    int earliest = s->n;
    for (int k = 0; k < s->pairs; k++) {
        double *column = x + (size_t)k * s->n;
        int first = s->n;
        for (int i = s->start[k] - 1; i < s->start[k + 1] - 1; i++) {
            const int at = place[s->equation[i] - 1];
            column[at] += s->weight[i];
            if (at < first) first = at;
        }
        const int left = s->n - first;
        if (left > 0) dtbsv_("L", "N", "N", &left, &width, band + (size_t)first * height, &height, column + first, &single);
        if (first < earliest) earliest = first;
    }
    const int left = s->n - earliest;
    dsyrk_("L", "T", &s->pairs, &left, &one, x + earliest, &s->n, &none, flexibility, &s->pairs);
    free(x);
}

static double again(const scene *s, int last, int width, const int *place, double *band, double *flexibility, double *spent) {
    const int height = width + 1, single = 1;
    double *force = room(s->pairs, sizeof(double)), *x = room(s->n, sizeof(double)), *u = room(s->n, sizeof(double));
    memset(band, 0, (size_t)height * s->n * sizeof(double));
    for (int e = 0; e < s->entries; e++) {
        const int i = place[s->row[e] - 1], j = place[s->column[e] - 1];
        band[(size_t)(i < j ? i : j) * height + abs(i - j)] = s->value[e];
    }
    double begun = now(), error;
    int info = 0;
    dpbtrf_("L", &s->n, &width, band, &height, &info);
    if (info) fail("LAPACK did not factor");
    spent[FACTOR] = now() - begun, begun = now();
    (last ? from_block : from_columns)(s, width, band, place, flexibility);
    spent[FLEXIBILITY] = now() - begun, begun = now();
    solve_contact(s, flexibility, force);
    spent[CONTACT] = now() - begun, begun = now();
    add_forces(s, force, u);
    for (int i = 0; i < s->n; i++) x[place[i]] = u[i];
    dpbtrs_("L", &s->n, &width, &single, band, &height, x, &s->n, &info);
    for (int i = 0; i < s->n; i++) u[i] = x[place[i]];
    spent[DISPLACEMENTS] = now() - begun;
    error = error_of(s, u);
    free(force), free(x), free(u);
    return error;
}

double by_band(const scene *s, int ordering, int kind, int last, double *spent, double *more) {
    (void)ordering, (void)kind;
    int *place = room(s->n, sizeof(int));
    double begun = now(), next[STAGES];
    const int width = number(s, last, place);
    spent[ORDERING] = now() - begun;
    double *band = room((size_t)(width + 1) * s->n, sizeof(double)), *flexibility = room((size_t)s->pairs * s->pairs, sizeof(double));
    const double error = again(s, last, width, place, band, flexibility, spent);
    *more = 0.0;
    for (int i = 0; i < FURTHER; i++) {
        again(s, last, width, place, band, flexibility, next);
        for (int j = FACTOR; j < STAGES; j++) *more += next[j];
    }
    free(place), free(band), free(flexibility);
    return error;
}
