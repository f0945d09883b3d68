/* qless finds redundant and conflicting linear constraint equations C u = b, and computes their reduced form
 *
 *     u_s = T u_q + G u_p + g        slaves u_s, masters u_q, prescribed DOFs u_p
 *
 * Status. A function that returns an int returns QLESS_OK, QLESS_AMBIGUOUS, QLESS_INCOMPLETE, or a negative number if it failed;
 * qless_message() then has the reason. After a failure nothing has changed, but output arrays may be partly written.
 * Handles. Free each handle by the function of its type that ends in _free. A null, freed or foreign handle is an error.
 * Arrays. Input is copied. Output goes to arrays of the caller. Compressed rows: entries starts[i] .. starts[i + 1] belong to row i.
 * Sizes that are not known. With room 0 only count or length is set; then call again with that room.
 * Texts. UTF-8 with a closing zero, which length includes.
 * Integers. Functions that end in _64 take 64-bit indices. Lengths are 64-bit everywhere.
 * Base. Equations, DOFs, starts, columns, elements, groups, ways, load cases and warnings count from base, which is 0 or 1.
 * Threads. One handle may be used by several threads at once; qless_refresh waits until the others are done.
 * Ranks of an MPI job. Include qless_mpi.h; the library itself links no MPI.
 */
#ifndef QLESS_H
#define QLESS_H

#include <stdint.h>

#define QLESS_VERSION_MAJOR 0
#define QLESS_VERSION_MINOR 1
#define QLESS_VERSION_PATCH 0

#define QLESS_OK 0         /* success */
#define QLESS_AMBIGUOUS 1  /* success, but another rank or verdict is possible (qless_analyse, qless_deck_analyse, qless_refresh) */
#define QLESS_INCOMPLETE 2 /* success, but constraints of the deck were left out (qless_deck_read, qless_deck_clean) */
#define QLESS_INPUT -1     /* an argument is not valid */
#define QLESS_CONFLICT -2  /* equations conflict, so that there is no reduced form */
#define QLESS_NUMERICAL -3 /* too little memory for a block, or equations too nearly dependent */
#define QLESS_INTERNAL -4  /* a bug of the library */
#define QLESS_FILE -5      /* a file cannot be read or written, or a deck is malformed or cannot be cleaned */
#define QLESS_RANKS -6     /* a function of qless_ranks failed */

#define QLESS_INDEPENDENT 0 /* kinds of equations */
#define QLESS_REDUNDANT 1
#define QLESS_CONFLICTING 2

#define QLESS_EQUATION 0 /* what an index counts */
#define QLESS_DOF 1
#define QLESS_PRESCRIBED 2

#define QLESS_ROWS 0 /* lines of K and K_q */
#define QLESS_COLUMNS 1

#define QLESS_FULL 0  /* entries of K and K_q that are stored: all, */
#define QLESS_LOWER 1 /* or those with column <= row of a symmetric matrix, */
#define QLESS_UPPER 2 /* or those with column >= row */

#define QLESS_ELIMINATED 0 /* prescribed DOFs: no unknowns of K_q, */
#define QLESS_KEPT 1       /* or unknowns, for a solver that prescribes them itself */

#define QLESS_NO_DOUBT 0          /* doubts of qless_doubt */
#define QLESS_DOUBT_NEAR 1        /* kept equations become dependent if coefficients are wrong in their last digits */
#define QLESS_DOUBT_NO_GAP 2      /* dropped equations differ from combinations of kept ones by more than rounding */
#define QLESS_DOUBT_MISMATCH 3    /* right-hand sides of dependent equations may be meant as equal */
#define QLESS_DOUBT_NOISE 4       /* coefficients that may be rounding decide the result */
#define QLESS_DOUBT_ELIMINATION 5 /* the rank could not be verified within the memory that is allowed */
#define QLESS_DOUBT_UNPROVED 6    /* effort "proved": the verdict on some equation has no proof */
#define QLESS_DOUBT_EXACT 7       /* effort "exact": exact arithmetic has another result */
#define QLESS_DOUBT_OTHER 8

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
typedef struct qless_pattern qless_pattern;
typedef struct qless_deck qless_deck;
typedef struct qless_distributed qless_distributed;

/* A member of a reason: coefficient times an equation (QLESS_EQUATION), or times u_index = value (QLESS_PRESCRIBED). */
typedef struct qless_member {
    int64_t what;
    int64_t index;
    double coefficient;
} qless_member;

/* Another right-hand side of an equation (QLESS_EQUATION), or another prescribed value of a DOF (QLESS_PRESCRIBED). */
typedef struct qless_change {
    int64_t what;
    int64_t index;
    double from;
    double to;
} qless_change;

/* Adds K_e, by rows, and f_e of an element to arrays of zeros. Another result than 0 stops the assembly. */
typedef int (*qless_element)(void *context, int64_t element, double *matrix, double *forces);

/* Passes messages between the ranks of a job. Each function is collective, works like the function of MPI on 64-bit words that is named, and
 * returns 0, or another number if it failed. The library calls it on the thread of the caller only.
 * exchange: MPI_Alltoallv. sent has sent_counts[r] words for rank r, received gets received_counts[r] words from rank r, in the order of
 * ranks without gaps. reduce: MPI_Allreduce in place, the sums (which wrap), or the maxima if is_max is 1. gather: MPI_Allgather of count
 * numbers from each rank. */
typedef int (*qless_exchange)(void *context, const uint64_t *sent, const int64_t *sent_counts, uint64_t *received,
                              const int64_t *received_counts);
typedef int (*qless_reduce)(void *context, uint64_t *numbers, int64_t count, int is_max);
typedef int (*qless_gather)(void *context, const uint64_t *numbers, int64_t count, uint64_t *all);

/* The ranks of a job: those of an MPI communicator by qless_mpi_ranks of qless_mpi.h, or by functions of the caller. rank counts from 0. */
typedef struct qless_ranks {
    void *context;
    int32_t rank;
    int32_t size;
    qless_exchange exchange;
    qless_reduce reduce;
    qless_gather gather;
} qless_ranks;

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
 * rhs: equations numbers, or null for zeros; prescribed_dofs, prescribed_values: prescribed_count numbers; options: null for defaults. */
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

/* The free DOFs that the equations fix (generated boundary conditions), ascending, and their values. room: length of dofs and values. */
QLESS_API int qless_fixed(const qless_analysis *analysis, int32_t *dofs, double *values, int64_t room, int64_t *count);
QLESS_API int qless_fixed_64(const qless_analysis *analysis, int64_t *dofs, double *values, int64_t room, int64_t *count);

/* Why an equation is dependent (what = QLESS_EQUATION) or a DOF fixed (QLESS_DOF): few equations and prescribed values whose sum over all
 * DOFs is the equation, or u_index = rhs. rhs: right-hand side of the sum; an equation conflicts if its own differs. irreducible: 1 if none
 * can be left out, 0 if that is not known (more than 128 equations, some with small coefficients). count is 0 for an independent equation,
 * a DOF that is not fixed, and the equation 0 = b. */
QLESS_API int qless_reason(const qless_analysis *analysis, int what, int64_t index, qless_member *members, int64_t room, double *rhs,
                           int *irreducible, int64_t *count);

/* What to change so that no conflict is left. Conflicts that have numbers in common form a group and are cured together; each way of a
 * group cures all of them, the most plausible way comes first, and all have the same number of changes. At most 16 ways are listed, fewer
 * if they take long to verify, and none if more than 64 conflicts have no single change that cures them. Without conflicts there is no
 * group. */
QLESS_API int qless_repairs(const qless_analysis *analysis, int64_t *groups);
QLESS_API int qless_repair_sizes(const qless_analysis *analysis, int64_t group, int64_t *conflicts, int64_t *ways, int64_t *changes);
QLESS_API int qless_repair_conflicts(const qless_analysis *analysis, int64_t group, int64_t *rows, int64_t length);
QLESS_API int qless_repair(const qless_analysis *analysis, int64_t group, int64_t way, qless_change *changes, int64_t length);

/* Why the verdict is ambiguous: doubt is QLESS_NO_DOUBT or one of the doubts; text has a line for it, for the other rank if numbers that
 * may be rounding are read the other way, and for a verdict on a deck that holds for some times only. It is empty if there is none. */
QLESS_API int qless_doubt(const qless_analysis *analysis, int *doubt, char *text, int64_t room, int64_t *length);

/* The label of an equation (QLESS_EQUATION) or DOF (QLESS_DOF), or the place of a prescribed value (QLESS_PRESCRIBED; empty if there is
 * none). Those of a deck name card and line, or node and component: "line 7 *EQUATION 1:1", "4:2", "line 20 *BOUNDARY". Without a deck they
 * are "row 1", "DOF 1", counted from 1. */
QLESS_API int qless_label(const qless_analysis *analysis, int what, int64_t index, char *text, int64_t room, int64_t *length);

/* Reads a deck of CalculiX, Abaqus, Nastran or ANSYS with the files that it includes. Its first cards decide the format. solver: "ccx",
 * "abaqus", "nastran", "mystran", "optistruct", "ansys", or null for the default of the format. QLESS_FILE: qless_message() has file, line,
 * card and field. */
QLESS_API int qless_deck_read(const char *path, const char *solver, int base, qless_deck **deck);
QLESS_API int qless_deck_free(qless_deck *deck);

/* Numbers of equations, load cases (steps or subcases; at least one) and warnings, and of warnings about constraints that were left out. */
QLESS_API int qless_deck_counts(const qless_deck *deck, int64_t *equations, int64_t *load_cases, int64_t *warnings, int64_t *left_out);

/* The name of a load case, such as "step 1"; a warning with its line. Those about constraints that were left out come first. */
QLESS_API int qless_deck_load_case(const qless_deck *deck, int64_t load_case, char *text, int64_t room, int64_t *length);
QLESS_API int qless_deck_warning(const qless_deck *deck, int64_t warning, char *text, int64_t room, int64_t *length);

/* Diagnoses a load case; -1 for any, if all constrain the same. Rows: the equations in force in the order of the deck, then prescribed
 * values that contradict others. If prescribed values follow several time histories, their conflicts at other times count as well. */
QLESS_API int qless_deck_analyse(const qless_deck *deck, int64_t load_case, const qless_options *options, qless_analysis **analysis);

/* Writes the deck to a file with an equivalent, independent set of constraints, proved to constrain the same in every load case; nothing
 * else changes. removed, written: numbers of equations that were removed, and that were written instead, or null. QLESS_CONFLICT if
 * equations conflict in a load case. */
QLESS_API int qless_deck_clean(const qless_deck *deck, const qless_options *options, const char *path, int64_t *removed, int64_t *written);

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

/* Sets new b (one number for each equation) and prescribed values (in the order of qless_dofs). Slaves and T stay. QLESS_AMBIGUOUS
 * if another rank or verdict is possible; QLESS_CONFLICT if equations conflict for these values, and nothing has changed then. */
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

/* Reactions C^T lambda - (f - K u) at the prescribed DOFs, in their order, from residual = f - K u and lambda. */
QLESS_API int qless_reactions(const qless_elimination *elimination, const double *residual, int64_t residual_length, const double *lambda,
                              int64_t lambda_length, double *reactions, int64_t reactions_length);

/* The pattern of K_q = L^T K L for all matrices K with this pattern, once. K has dofs lines (as many as DOFs), which are QLESS_ROWS or
 * QLESS_COLUMNS; starts: dofs + 1 numbers; index: as many as starts says, in any order, summed if they repeat. storage: QLESS_FULL,
 * QLESS_LOWER or QLESS_UPPER. prescribed: QLESS_ELIMINATED or QLESS_KEPT. Base is that of the elimination. */
QLESS_API int qless_condensed(const qless_elimination *elimination, int64_t dofs, int lines, int storage, int prescribed,
                              const int32_t *starts, const int32_t *index, qless_pattern **pattern);
QLESS_API int qless_condensed_64(const qless_elimination *elimination, int64_t dofs, int lines, int storage, int prescribed,
                                 const int64_t *starts, const int64_t *index, qless_pattern **pattern);

/* The same for the elements of a model, without K: element e has the DOFs dofs[starts[e]] .. dofs[starts[e + 1]]. Lines are rows. */
QLESS_API int qless_condensed_for_elements(const qless_elimination *elimination, int64_t elements, int storage, int prescribed,
                                           const int32_t *starts, const int32_t *dofs, qless_pattern **pattern);
QLESS_API int qless_condensed_for_elements_64(const qless_elimination *elimination, int64_t elements, int storage, int prescribed,
                                              const int64_t *starts, const int64_t *dofs, qless_pattern **pattern);

/* A pattern keeps its elimination, which may be freed before it, and follows qless_refresh. */
QLESS_API int qless_pattern_free(qless_pattern *pattern);

/* Numbers of unknowns and of stored entries of K_q. */
QLESS_API int qless_pattern_sizes(const qless_pattern *pattern, int64_t *unknowns, int64_t *entries);

/* K_q in compressed lines like those of K (rows or columns, the same half), ascending in each line, and the DOF of each unknown: masters,
 * and prescribed DOFs if they are kept. starts: unknowns + 1 numbers; index: entries; dofs: unknowns; null for an array not wanted. */
QLESS_API int qless_pattern_arrays(const qless_pattern *pattern, int32_t *starts, int32_t *index, int32_t *dofs);
QLESS_API int qless_pattern_arrays_64(const qless_pattern *pattern, int64_t *starts, int64_t *index, int64_t *dofs);

/* K_q = L^T K L and f_q = L^T (f - K u_0), for values k in the order of the pattern of K and forces f on all DOFs; u_0 holds g and the
 * prescribed values of the last qless_refresh. With f and f_q null only K_q (a mass matrix, say), with k_q null only f_q. */
QLESS_API int qless_condense(const qless_pattern *pattern, const double *k, int64_t k_length, const double *f, int64_t f_length,
                             double *k_q, int64_t k_q_length, double *f_q, int64_t f_q_length);

/* K_q and f_q from all elements of qless_condensed_for_elements. Threads call element with context at the same time, for some elements more
 * than once and for those without unknowns never; sums are in the order of the elements. element must not throw, and must not use the
 * elimination of the pattern. QLESS_INPUT if it returns another number than 0; k_q and f_q are then not valid. */
QLESS_API int qless_assemble(const qless_pattern *pattern, qless_element element, void *context, double *k_q, int64_t k_q_length,
                             double *f_q, int64_t f_q_length);

/* Adds one element to K_q and f_q, for codes with a loop of their own over elements: count DOFs, matrix by rows, count forces. Its entries
 * must be in the pattern. After a failure k_q and f_q are not valid. */
QLESS_API int qless_add_element(const qless_pattern *pattern, int64_t count, const int32_t *dofs, const double *matrix,
                                const double *forces, double *k_q, int64_t k_q_length, double *f_q, int64_t f_q_length);
QLESS_API int qless_add_element_64(const qless_pattern *pattern, int64_t count, const int64_t *dofs, const double *matrix,
                                   const double *forces, double *k_q, int64_t k_q_length, double *f_q, int64_t f_q_length);

/* The same over the ranks of a job: every rank calls qless_analyse_ranks and qless_distributed_eliminate with its part, in the same order.
 * DOFs and equations have numbers in the job (messages count them from 0). Results do not depend on the distribution: they are those of
 * qless_analyse for the equations in the order of their numbers, to the last bit. If an argument is not valid on one rank, or equations
 * conflict, all ranks return the same status and message. If a function of ranks fails, this rank returns QLESS_RANKS; others may still
 * wait for it, so end the job. */

/* Diagnoses C u = b. This rank owns the DOFs first_dof .. end_dof - 1; the ranges of all ranks follow one another from base. It gives any
 * equations of the job, in compressed rows as in qless_analyse; numbers: the number of each, below 2^62, each once in the job. Several
 * ranks may prescribe a DOF with equal values. needed_dofs: DOFs of other ranks whose rows of T this rank needs. All ranks give the same
 * base and options. QLESS_AMBIGUOUS on all ranks if another rank or verdict is possible. */
QLESS_API int qless_analyse_ranks(const qless_ranks *ranks, int base, int64_t first_dof, int64_t end_dof, int64_t equations,
                                  const int64_t *numbers, const int64_t *starts, const int64_t *columns, const double *values,
                                  const double *rhs, int64_t prescribed_count, const int64_t *prescribed_dofs,
                                  const double *prescribed_values, int64_t needed_count, const int64_t *needed_dofs,
                                  const qless_options *options, qless_distributed **distributed);
QLESS_API int qless_distributed_free(qless_distributed *distributed);

/* Numbers of equations and DOFs of the whole job, the rank of C, and the numbers of redundant and of conflicting equations. */
QLESS_API int qless_distributed_counts(const qless_distributed *distributed, int64_t *equations, int64_t *dofs, int64_t *rank,
                                       int64_t *redundant, int64_t *conflicting);

/* The kind of each equation that this rank gave, in its order; length: their number. */
QLESS_API int qless_distributed_kinds(const qless_distributed *distributed, int8_t *kinds, int64_t length);

/* As qless_explanation, for an equation that this rank gave: row counts these from base; numbers: those in the job, of any rank. */
QLESS_API int qless_distributed_explanation(const qless_distributed *distributed, int64_t row, int64_t *numbers, double *coefficients,
                                            int64_t room, int64_t *count);

/* Solves for the slaves; QLESS_CONFLICT on all ranks if equations conflict. The elimination is that of the local DOFs: those that this rank
 * owns or needs, and those in their rows of T and G. Its functions number them from base, ascending. It has no equations, so that
 * qless_refresh, qless_multipliers and qless_reactions fail. */
QLESS_API int qless_distributed_eliminate(const qless_ranks *ranks, const qless_distributed *distributed, qless_elimination **elimination);

/* The number in the job of each local DOF, and of the masters that this rank owns, ascending. room: length of the array. */
QLESS_API int qless_distributed_dofs(const qless_elimination *elimination, int64_t *dofs, int64_t room, int64_t *count);
QLESS_API int qless_distributed_masters(const qless_elimination *elimination, int64_t *masters, int64_t room, int64_t *count);

#ifdef __cplusplus
}
#endif

#endif
