/* qless finds redundant and conflicting linear constraint equations C u = b, and computes their reduced form
 *
 *     u_s = T u_q + G u_p + g        slaves u_s, masters u_q, prescribed DOFs u_p
 *
 * Status. A function that returns an int returns QLESS_OK, QLESS_AMBIGUOUS, or a negative number if it failed; qless_message() then has the
 * reason. After a failure nothing has changed.
 * Handles. Free each handle by the function of its type that ends in _free. A null, freed or foreign handle is an error.
 * Arrays. Input is copied. Output goes to arrays of the caller. Compressed rows: entries starts[i] .. starts[i + 1] belong to row i.
 * Integers. Functions that end in _64 take 64-bit indices. Lengths are 64-bit everywhere.
 * Base. Equations, DOFs, starts and columns count from base, which is 0 or 1, in input and results.
 * Threads. One handle may be used by several threads at once; qless_refresh waits until the others are done.
 */
#ifndef QLESS_H
#define QLESS_H

#include <stdint.h>

#define QLESS_VERSION_MAJOR 0
#define QLESS_VERSION_MINOR 1
#define QLESS_VERSION_PATCH 0

#define QLESS_OK 0         /* success */
#define QLESS_AMBIGUOUS 1  /* success, but another rank or verdict is possible (qless_analyse only) */
#define QLESS_INPUT -1     /* an argument is not valid */
#define QLESS_CONFLICT -2  /* equations conflict, so that there is no reduced form */
#define QLESS_NUMERICAL -3 /* too little memory for a block, or equations too nearly dependent */
#define QLESS_INTERNAL -4  /* a bug of the library */

#define QLESS_INDEPENDENT 0 /* kinds of equations */
#define QLESS_REDUNDANT 1
#define QLESS_CONFLICTING 2

#if defined(_WIN32)
#define QLESS_API __declspec(dllimport)
#else
#define QLESS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct qless_options qless_options;
typedef struct qless_analysis qless_analysis;
typedef struct qless_elimination qless_elimination;

/* Version of the library, such as "0.1.0"; valid for ever. */
QLESS_API const char *qless_version(void);

/* Message of the last call that failed on this thread, or an empty text; valid until the next call that fails on it. */
QLESS_API const char *qless_message(void);

/* Options with their defaults. */
QLESS_API int qless_options_create(qless_options **options);
QLESS_API int qless_options_free(qless_options *options);

/* "tolerance" (relative, 1e-10), "noise" (relative size), "growth" (bound of |T_ij|, 4), "memory" (bytes), "presolve" (0 or 1). */
QLESS_API int qless_options_set_number(qless_options *options, const char *name, double value);

/* "effort" ("quick", "checked", "proved", "exact"), "backend" ("faer", "sparse", "gauss"), "noise" ("auto", "none"),
 * "tolerance" ("paper"). */
QLESS_API int qless_options_set_word(qless_options *options, const char *name, const char *value);

/* Diagnoses C u = b. starts: equations + 1 numbers; columns, values: as many as starts says, in any order, summed if they repeat;
 * rhs: equations numbers, or null for zeros; prescribed_dofs, prescribed_values: prescribed_count numbers; options: null for the defaults. */
QLESS_API int qless_analyse(int64_t equations, int64_t dofs, int base, const int32_t *starts, const int32_t *columns, const double *values,
                            const double *rhs, int64_t prescribed_count, const int32_t *prescribed_dofs, const double *prescribed_values,
                            const qless_options *options, qless_analysis **analysis);
QLESS_API int qless_analyse_64(int64_t equations, int64_t dofs, int base, const int64_t *starts, const int64_t *columns,
                               const double *values, const double *rhs, int64_t prescribed_count, const int64_t *prescribed_dofs,
                               const double *prescribed_values, const qless_options *options, qless_analysis **analysis);

/* Eliminations that were made from the analysis stay valid. */
QLESS_API int qless_analysis_free(qless_analysis *analysis);

/* Numbers of equations and DOFs, the rank, and the numbers of redundant and of conflicting equations. */
QLESS_API int qless_counts(const qless_analysis *analysis, int64_t *equations, int64_t *dofs, int64_t *rank, int64_t *redundant,
                           int64_t *conflicting);

/* QLESS_INDEPENDENT, QLESS_REDUNDANT or QLESS_CONFLICTING for each equation; length: the number of equations. */
QLESS_API int qless_kinds(const qless_analysis *analysis, int8_t *kinds, int64_t length);

/* kept: -log10 of the smallest relative change of coefficients that makes the kept equations dependent; dropped: number of digits
 * in which dropped equations agree with their combinations of kept ones (infinite if all do); ambiguous: whether another rank or verdict is
 * possible. */
QLESS_API int qless_digits(const qless_analysis *analysis, double *kept, double *dropped, int *ambiguous);

/* Why an equation is dependent: row = sum of coefficients[k] * rows[k] over the free DOFs, for k < count. An independent one has count 0.
 * room: length of rows and coefficients. With room 0 only count is set. */
QLESS_API int qless_explanation(const qless_analysis *analysis, int64_t row, int32_t *rows, double *coefficients, int64_t room,
                                int64_t *count);
QLESS_API int qless_explanation_64(const qless_analysis *analysis, int64_t row, int64_t *rows, double *coefficients, int64_t room,
                                   int64_t *count);

/* Chooses slaves and solves for them; QLESS_CONFLICT if equations conflict. */
QLESS_API int qless_eliminate(const qless_analysis *analysis, qless_elimination **elimination);
QLESS_API int qless_elimination_free(qless_elimination *elimination);

/* Numbers of slaves, masters and prescribed DOFs, and of the entries of T and G. */
QLESS_API int qless_sizes(const qless_elimination *elimination, int64_t *slaves, int64_t *masters, int64_t *prescribed, int64_t *t_entries,
                          int64_t *g_entries);

/* The DOFs of each kind, ascending, in arrays as long as qless_sizes says; null for a list that is not wanted. */
QLESS_API int qless_dofs(const qless_elimination *elimination, int32_t *slaves, int32_t *masters, int32_t *prescribed);
QLESS_API int qless_dofs_64(const qless_elimination *elimination, int64_t *slaves, int64_t *masters, int64_t *prescribed);

/* T in compressed rows: row i is slave i, column q is master q. starts: slaves + 1 numbers; columns, values: t_entries. */
QLESS_API int qless_t(const qless_elimination *elimination, int32_t *starts, int32_t *columns, double *values);
QLESS_API int qless_t_64(const qless_elimination *elimination, int64_t *starts, int64_t *columns, double *values);

/* G in compressed rows: row i is slave i, column p is prescribed DOF p. starts: slaves + 1 numbers; columns, values: g_entries. */
QLESS_API int qless_g_matrix(const qless_elimination *elimination, int32_t *starts, int32_t *columns, double *values);
QLESS_API int qless_g_matrix_64(const qless_elimination *elimination, int64_t *starts, int64_t *columns, double *values);

/* g, for the current b and prescribed values; length: the number of slaves. */
QLESS_API int qless_g(const qless_elimination *elimination, double *g, int64_t length);

/* Sets new b (one number for each equation) and prescribed values (in the order of qless_dofs). Slaves and T stay. QLESS_CONFLICT if
 * equations conflict for these values; nothing has changed then. */
QLESS_API int qless_refresh(qless_elimination *elimination, const double *rhs, int64_t rhs_length, const double *prescribed,
                            int64_t prescribed_length);

/* u = L u_q + u_0: all DOFs from the masters. Arrays must not overlap, here and below. */
QLESS_API int qless_expand(const qless_elimination *elimination, const double *masters, int64_t masters_length, double *u,
                           int64_t u_length);

/* du = L du_q. */
QLESS_API int qless_expand_increment(const qless_elimination *elimination, const double *masters, int64_t masters_length, double *du,
                                     int64_t du_length);

/* f_q = L^T f: forces on all DOFs, transferred to the masters. */
QLESS_API int qless_restrict(const qless_elimination *elimination, const double *forces, int64_t forces_length, double *masters,
                             int64_t masters_length);

/* lambda of K u + C^T lambda = f, one number for each equation, from residual = f - K u; zero for dependent equations. */
QLESS_API int qless_multipliers(const qless_elimination *elimination, const double *residual, int64_t residual_length, double *lambda,
                                int64_t lambda_length);

#ifdef __cplusplus
}
#endif

#endif
