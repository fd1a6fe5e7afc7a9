/* Shared by the libraries: the model, and the contact solution after F. */
#ifndef BARE_H
#define BARE_H

#include <stddef.h>

/* Seconds of a method. */
enum { ORDERING, FACTOR, FLEXIBILITY, CONTACT, DISPLACEMENTS, STAGES };
enum { FURTHER = 7 };    /* repetitions with the same ordering */

typedef struct {
    int n, entries, pairs, row_entries, motions;
    int *row, *column;                          /* lower triangle by columns, from 1 */
    int *start, *equation, *touching;           /* rows of N, from 1 */
    double *value, *weight, *gap, *motion, *resultant, *load, *displacement;
    int contacts, *contact, *place;             /* equations in N, from 0; the position of each among them, or -1 */
    int solves;                                 /* CHOLMOD: only one factor and one solve, no F and no contact */
} scene;

typedef struct {
    const char *name;
    /* Run everything once, then repeat FURTHER times from the factor on (their seconds go to `more`); error of the displacements. */
    double (*run)(const scene *s, int ordering, int kind, int last, double *spent, double *more);
    int ordering;    /* the library's */
    int kind;        /* CHOLMOD's: simplicial or supernodal */
    int last;        /* contact equations last */
} method;

double by_band(const scene *s, int ordering, int kind, int last, double *spent, double *more);
double by_cholmod(const scene *s, int ordering, int kind, int last, double *spent, double *more);
double by_mumps(const scene *s, int ordering, int kind, int last, double *spent, double *more);

double now(void);               /* processor time [s] */
void fail(const char *what);
void *room(size_t count, size_t size);

/* F = X'X with X = L^-1 N', L the factor of the contacts' complement [contacts, contacts], its rows by `at`. */
void square(const scene *s, const double *factor, const int *at, double *flexibility);

/* Forces of the pairs in contact: F R - A q = -gap there, A'R = P. F is full or a lower triangle. */
void solve_contact(const scene *s, const double *flexibility, double *force);

/* x = f + N'R. */
void add_forces(const scene *s, const double *force, double *x);

/* Largest difference from the given displacements, relative to the largest. */
double error_of(const scene *s, const double *x);

/* BLAS and LAPACK. */
void dpotrf_(const char *, const int *, double *, const int *, int *);
void dpotrs_(const char *, const int *, const int *, const double *, const int *, double *, const int *, int *);
void dsyrk_(const char *, const char *, const int *, const int *, const double *, const double *, const int *, const double *,
            double *, const int *);
void dtrsm_(const char *, const char *, const char *, const char *, const int *, const int *, const double *, const double *,
            const int *, double *, const int *);
void dpbtrf_(const char *, const int *, const int *, double *, const int *, int *);
void dpbtrs_(const char *, const int *, const int *, const int *, const double *, const int *, double *, const int *, int *);
void dtbsv_(const char *, const char *, const char *, const int *, const int *, const double *, const int *, double *, const int *);

#endif
