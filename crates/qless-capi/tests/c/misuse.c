/* Null, wrong lengths, freed and foreign handles, two threads on one handle: errors, no crash. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "qless.h"

#define NEED(condition)                                                                  \
    do {                                                                                 \
        if (!(condition)) {                                                              \
            fprintf(stderr, "line %d: %s (%s)\n", __LINE__, #condition, qless_message()); \
            exit(1);                                                                     \
        }                                                                                \
    } while (0)

static const int32_t starts[] = {0, 2, 4}, columns[] = {0, 1, 1, 2};
static const double values[] = {1, -1, 1, -1};

static qless_analysis *analysed(const double *rhs)
{
    qless_analysis *analysis = NULL;
    NEED(qless_analyse(2, 3, 0, starts, columns, values, rhs, 0, NULL, NULL, NULL, &analysis) == QLESS_OK);
    return analysis;
}

static void bad_systems(void)
{
    qless_analysis *analysis = NULL;
    const int32_t falling[] = {0, 2, 1}, outside[] = {0, 1, 1, 3}, below[] = {0, 1, 1, -1};
    const double bad[] = {1, NAN, 1, -1};
    NEED(qless_analyse(2, 3, 0, starts, columns, values, NULL, 0, NULL, NULL, NULL, NULL) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 0, NULL, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 0, starts, NULL, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(-2, 3, 0, starts, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 0, 0, starts, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 2, starts, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 1, starts, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 0, falling, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 0, starts, below, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(qless_analyse(2, 3, 0, starts, columns, bad, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(strstr(qless_message(), "row 0, DOF 1 is NaN"));
    NEED(qless_analyse(2, 3, 0, starts, outside, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(strstr(qless_message(), "row 1, DOF 3 names DOF 3"));
    NEED(qless_analyse(INT64_MAX, 3, 0, starts, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    const int32_t *between = (const int32_t *)((const char *)starts + 1);
    NEED(qless_analyse(2, 3, 0, between, columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
    NEED(analysis == NULL);
}

static void bad_handles(void)
{
    int64_t n[5];
    int8_t kinds[2];
    double u[3], masters[1] = {1};
    qless_analysis *analysis = analysed(NULL);
    qless_elimination *elimination = NULL;
    NEED(qless_kinds(analysis, kinds, 3) == QLESS_INPUT);
    NEED(qless_kinds(analysis, NULL, 2) == QLESS_INPUT);
    NEED(qless_counts(NULL, n, n + 1, n + 2, n + 3, n + 4) == QLESS_INPUT);
    NEED(qless_counts((const qless_analysis *)&u, n, n + 1, n + 2, n + 3, n + 4) == QLESS_INPUT);
    NEED(qless_eliminate(analysis, NULL) == QLESS_INPUT);
    NEED(qless_eliminate(analysis, &elimination) == QLESS_OK);
    NEED(qless_expand((const qless_elimination *)analysis, masters, 1, u, 3) == QLESS_INPUT);
    NEED(qless_expand(elimination, masters, 1, u, 2) == QLESS_INPUT);
    NEED(qless_expand(elimination, masters, 0, u, 3) == QLESS_INPUT);
    NEED(qless_expand(elimination, masters, -1, u, 3) == QLESS_INPUT);
    NEED(qless_refresh(elimination, u, 3, NULL, 0) == QLESS_INPUT);
    NEED(qless_analysis_free(analysis) == QLESS_OK);
    NEED(qless_analysis_free(analysis) == QLESS_INPUT);
    NEED(strstr(qless_message(), "was freed"));
    NEED(qless_analysis_free(NULL) == QLESS_OK);
    NEED(qless_kinds(analysis, kinds, 2) == QLESS_INPUT);
    NEED(qless_expand(elimination, masters, 1, u, 3) == QLESS_OK && u[0] == 1);
    NEED(qless_elimination_free(elimination) == QLESS_OK);
    NEED(qless_expand(elimination, masters, 1, u, 3) == QLESS_INPUT);
}

static void bad_options(void)
{
    qless_options *options = NULL;
    NEED(qless_options_create(NULL) == QLESS_INPUT);
    NEED(qless_options_create(&options) == QLESS_OK);
    NEED(qless_options_set_number(options, "tolerance", 2) == QLESS_INPUT);
    NEED(qless_options_set_number(options, "colour", 2) == QLESS_INPUT);
    NEED(qless_options_set_number(options, NULL, 2) == QLESS_INPUT);
    NEED(qless_options_set_word(options, "backend", "magic") == QLESS_INPUT);
    NEED(qless_options_set_word(options, "backend", "sparse") == QLESS_OK);
    NEED(qless_options_free(options) == QLESS_OK);
    NEED(qless_options_set_word(options, "backend", "sparse") == QLESS_INPUT);
}

static void conflicts(void)
{
    const int32_t twice[] = {0, 1, 0, 1};
    const double rhs[] = {0, 1}, same[] = {2, 2}, near[] = {2, 2 + 1e-11};
    double g[1];
    qless_analysis *analysis = NULL;
    qless_elimination *elimination = NULL;
    NEED(qless_analyse(2, 2, 0, starts, twice, values, rhs, 0, NULL, NULL, NULL, &analysis) >= 0);
    NEED(qless_eliminate(analysis, &elimination) == QLESS_CONFLICT && elimination == NULL);
    NEED(qless_analysis_free(analysis) == QLESS_OK);
    NEED(qless_analyse(2, 2, 0, starts, twice, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_OK);
    NEED(qless_eliminate(analysis, &elimination) == QLESS_OK);
    NEED(qless_refresh(elimination, rhs, 2, NULL, 0) == QLESS_CONFLICT);
    NEED(qless_g(elimination, g, 1) == QLESS_OK && g[0] == 0);
    NEED(qless_refresh(elimination, near, 2, NULL, 0) == QLESS_AMBIGUOUS);
    NEED(qless_refresh(elimination, same, 2, NULL, 0) == QLESS_OK);
    NEED(qless_g(elimination, g, 1) == QLESS_OK && fabs(g[0]) == 2);
    NEED(qless_analysis_free(analysis) == QLESS_OK && qless_elimination_free(elimination) == QLESS_OK);
}

static const int32_t k_starts[] = {0, 2, 5, 7}, k_index[] = {0, 1, 0, 1, 2, 1, 2};
static const double k[] = {2, -1, -1, 2, -1, -1, 2}, f[] = {1, 1, 1};

static void bad_patterns(void)
{
    const int32_t outside[] = {0, 3, 0, 1, 2, 1, 2}, falling[] = {0, 5, 2, 7};
    double k_q[1], f_q[1];
    int64_t unknowns, entries;
    qless_analysis *analysis = analysed(NULL);
    qless_elimination *e = NULL;
    qless_pattern *p = NULL;
    NEED(qless_eliminate(analysis, &e) == QLESS_OK && qless_analysis_free(analysis) == QLESS_OK);
    NEED(qless_condensed(NULL, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, NULL, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, NULL, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, NULL) == QLESS_INPUT);
    NEED(qless_condensed(e, 2, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, -3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, INT64_MAX, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, 7, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, 7, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, 7, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_LOWER, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, outside, &p) == QLESS_INPUT);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, falling, k_index, &p) == QLESS_INPUT);
    NEED(p == NULL);
    NEED(qless_condensed(e, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &p) == QLESS_OK);
    NEED(qless_elimination_free(e) == QLESS_OK); /* the pattern keeps it */
    NEED(qless_pattern_sizes(p, &unknowns, &entries) == QLESS_OK && unknowns == 1 && entries == 1);
    NEED(qless_pattern_sizes(p, NULL, &entries) == QLESS_INPUT);
    NEED(qless_pattern_arrays(p, NULL, NULL, NULL) == QLESS_OK);
    NEED(qless_pattern_arrays((const qless_pattern *)e, NULL, NULL, NULL) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, f, 3, k_q, 1, f_q, 1) == QLESS_OK && k_q[0] == 2 && f_q[0] == 3);
    NEED(qless_condense(p, k, 6, f, 3, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, f, 2, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, f, 3, k_q, 2, f_q, 1) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, f, 3, k_q, 1, f_q, 0) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, f, 3, k_q, 1, NULL, 0) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, NULL, 0, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_condense(p, NULL, 7, f, 3, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, NULL, 0, NULL, 0, NULL, 0) == QLESS_INPUT);
    NEED(qless_condense(p, k, 7, NULL, 0, k_q, 1, NULL, 0) == QLESS_OK);
    NEED(qless_condense(p, k, 7, f, 3, NULL, 0, f_q, 1) == QLESS_OK);
    NEED(qless_assemble(p, NULL, NULL, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_pattern_free(p) == QLESS_OK && qless_pattern_free(p) == QLESS_INPUT && qless_pattern_free(NULL) == QLESS_OK);
    NEED(qless_condense(p, k, 7, f, 3, k_q, 1, f_q, 1) == QLESS_INPUT);
}

static int spring(void *context, int64_t element, double *matrix, double *forces)
{
    if (context != NULL && element == *(const int *)context)
        return 5;
    matrix[0] = matrix[3] = 1, matrix[1] = matrix[2] = -1, forces[0] = (double)element;
    return 0;
}

static void bad_elements(void)
{
    const int32_t of[] = {0, 1, 1, 2}, outside[] = {0, 1, 1, 3}, ends[] = {0, 2, 4}, falling[] = {0, 2, 1};
    const int stop = 1;
    double k_q[1], f_q[1];
    qless_analysis *analysis = analysed(NULL);
    qless_elimination *e = NULL;
    qless_pattern *p = NULL;
    NEED(qless_eliminate(analysis, &e) == QLESS_OK && qless_analysis_free(analysis) == QLESS_OK);
    NEED(qless_condensed_for_elements(e, 2, QLESS_FULL, QLESS_ELIMINATED, ends, outside, &p) == QLESS_INPUT);
    NEED(qless_condensed_for_elements(e, 2, QLESS_FULL, QLESS_ELIMINATED, falling, of, &p) == QLESS_INPUT);
    NEED(qless_condensed_for_elements(e, -1, QLESS_FULL, QLESS_ELIMINATED, ends, of, &p) == QLESS_INPUT);
    NEED(qless_condensed_for_elements(e, 2, QLESS_FULL, QLESS_ELIMINATED, NULL, of, &p) == QLESS_INPUT);
    NEED(qless_condensed_for_elements(e, 2, QLESS_FULL, QLESS_ELIMINATED, ends, of, &p) == QLESS_OK);
    NEED(qless_assemble(p, NULL, NULL, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_assemble(p, spring, NULL, k_q, 2, f_q, 1) == QLESS_INPUT);
    NEED(qless_assemble(p, spring, NULL, k_q, 1, NULL, 1) == QLESS_INPUT);
    NEED(qless_assemble(p, spring, (void *)&stop, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(strstr(qless_message(), "element 1: the function returned 5"));
    NEED(qless_assemble(p, spring, NULL, k_q, 1, f_q, 1) == QLESS_OK && k_q[0] == 0 && f_q[0] == 1);
    NEED(qless_add_element(p, 2, of, k, f, k_q, 1, f_q, 1) == QLESS_OK);
    NEED(qless_add_element(p, 0, NULL, NULL, NULL, k_q, 1, f_q, 1) == QLESS_OK);
    NEED(qless_add_element(p, 2, of + 2, k, NULL, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_add_element(p, 2, of, NULL, f, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_add_element(p, -2, of, k, f, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_add_element(p, INT64_MAX, of, k, f, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_add_element(p, 2, outside + 2, k, f, k_q, 1, f_q, 1) == QLESS_INPUT);
    NEED(qless_add_element(p, 2, of, k, f, k_q, 2, f_q, 1) == QLESS_INPUT);
    NEED(qless_pattern_free(p) == QLESS_OK && qless_elimination_free(e) == QLESS_OK);
}

static void bad_questions(void)
{
    const int32_t twice[] = {0, 1, 0, 1};
    const double rhs[] = {0, 1};
    int64_t count, groups, ways, changes, rows[1];
    int32_t dofs[2];
    int doubt, irreducible;
    double value;
    char text[64];
    qless_member members[2];
    qless_change change[1];
    qless_analysis *a = NULL;
    NEED(qless_analyse(2, 2, 0, starts, twice, values, rhs, 0, NULL, NULL, NULL, &a) >= 0);
    NEED(qless_reason(a, QLESS_EQUATION, 1, members, 1, &value, &irreducible, &count) == QLESS_OK && count == 1);
    NEED(members[0].index == 0 && irreducible == 1);
    NEED(qless_reason(a, QLESS_EQUATION, 1, members, -1, &value, &irreducible, &count) == QLESS_INPUT);
    NEED(qless_reason(a, QLESS_EQUATION, 1, NULL, 1, &value, &irreducible, &count) == QLESS_INPUT);
    NEED(qless_reason(a, QLESS_EQUATION, 1, NULL, 0, NULL, &irreducible, &count) == QLESS_INPUT);
    NEED(qless_reason(a, QLESS_EQUATION, 1, NULL, 0, &value, NULL, &count) == QLESS_INPUT);
    NEED(qless_reason(a, QLESS_EQUATION, 2, members, 1, &value, &irreducible, &count) == QLESS_INPUT);
    NEED(qless_reason(a, QLESS_DOF, -1, members, 1, &value, &irreducible, &count) == QLESS_INPUT);
    NEED(qless_reason(a, QLESS_DOF, 5, members, 0, &value, &irreducible, &count) == QLESS_OK && count == 0);
    NEED(qless_reason(a, QLESS_PRESCRIBED, 0, members, 1, &value, &irreducible, &count) == QLESS_INPUT);
    NEED(qless_repairs(a, NULL) == QLESS_INPUT && qless_repairs(NULL, &groups) == QLESS_INPUT);
    NEED(qless_repairs(a, &groups) == QLESS_OK && groups == 1);
    NEED(qless_repair_sizes(a, 0, &count, &ways, &changes) == QLESS_OK && count == 1 && ways == 2 && changes == 1);
    NEED(qless_repair_sizes(a, 1, &count, &ways, &changes) == QLESS_INPUT);
    NEED(qless_repair_conflicts(a, 0, rows, 2) == QLESS_INPUT);
    NEED(qless_repair_conflicts(a, 0, rows, 1) == QLESS_OK && rows[0] == 1);
    NEED(qless_repair(a, 0, 2, change, 1) == QLESS_INPUT && qless_repair(a, 0, 0, change, 0) == QLESS_INPUT);
    NEED(qless_repair(a, 0, 0, change, 1) == QLESS_OK && change[0].what == QLESS_EQUATION);
    NEED(qless_fixed(a, dofs, NULL, 2, &count) == QLESS_OK && count == 0 && qless_fixed(a, NULL, NULL, 0, NULL) == QLESS_INPUT);
    NEED(qless_label(a, QLESS_EQUATION, 1, text, 6, &count) == QLESS_OK && strcmp(text, "row 2") == 0 && count == 6);
    NEED(qless_label(a, QLESS_EQUATION, 1, text, 5, &count) == QLESS_INPUT);
    NEED(qless_label(a, QLESS_EQUATION, 1, NULL, 6, &count) == QLESS_INPUT);
    NEED(qless_label(a, QLESS_EQUATION, 2, text, 6, &count) == QLESS_INPUT);
    NEED(qless_label(a, 9, 0, text, 6, &count) == QLESS_INPUT);
    NEED(qless_doubt(a, NULL, text, 64, &count) == QLESS_INPUT && qless_doubt(a, &doubt, NULL, 0, NULL) == QLESS_INPUT);
    NEED(qless_analysis_free(a) == QLESS_OK);
}

static void bad_decks(void)
{
    int64_t n[4];
    char text[64];
    qless_deck *deck = NULL;
    qless_analysis *analysis = NULL;
    NEED(qless_deck_read("no/such.inp", NULL, 0, &deck) == QLESS_FILE && strstr(qless_message(), "no/such.inp: cannot be read"));
    NEED(qless_deck_read(NULL, NULL, 0, &deck) == QLESS_INPUT);
    NEED(qless_deck_read("\xff", NULL, 0, &deck) == QLESS_INPUT);
    NEED(qless_deck_read(DECK, "magic", 0, &deck) == QLESS_INPUT);
    NEED(qless_deck_read(DECK, "nastran", 0, &deck) == QLESS_FILE);
    NEED(qless_deck_read(DECK, NULL, 2, &deck) == QLESS_INPUT && qless_deck_read(DECK, NULL, 0, NULL) == QLESS_INPUT);
    NEED(deck == NULL && qless_deck_read(DECK, "ccx", 0, &deck) == QLESS_OK);
    NEED(qless_deck_counts(deck, n, n + 1, n + 2, NULL) == QLESS_INPUT);
    NEED(qless_deck_counts(deck, n, n + 1, n + 2, n + 3) == QLESS_OK && n[0] == 3 && n[1] == 1);
    NEED(qless_deck_load_case(deck, 1, text, 64, n) == QLESS_INPUT && qless_deck_load_case(deck, -1, text, 64, n) == QLESS_INPUT);
    NEED(qless_deck_load_case(deck, 0, text, 2, n) == QLESS_INPUT && qless_deck_warning(deck, 99, text, 64, n) == QLESS_INPUT);
    NEED(qless_deck_analyse(deck, 1, NULL, &analysis) == QLESS_INPUT && qless_deck_analyse(deck, -1, NULL, NULL) == QLESS_INPUT);
    NEED(qless_deck_analyse((const qless_deck *)text, -1, NULL, &analysis) == QLESS_INPUT && analysis == NULL);
    NEED(qless_deck_clean(deck, NULL, NULL, n, n + 1) == QLESS_INPUT);
    NEED(qless_deck_clean(deck, NULL, "no/such/folder.inp", n, n + 1) == QLESS_FILE);
    NEED(qless_deck_analyse(deck, -1, NULL, &analysis) == QLESS_OK);
    NEED(qless_deck_free(deck) == QLESS_OK && qless_deck_free(deck) == QLESS_INPUT && qless_deck_free(NULL) == QLESS_OK);
    NEED(qless_deck_clean(deck, NULL, "folder.inp", n, n + 1) == QLESS_INPUT);
    NEED(qless_label(analysis, QLESS_EQUATION, 2, text, 64, n) == QLESS_OK && strcmp(text, "line 13 *EQUATION 1:1") == 0);
    NEED(qless_analysis_free(analysis) == QLESS_OK);
}

static void *use(void *handle)
{
    double u[3], masters[1] = {1}, rhs[2] = {0, 0}, lambda[2];
    for (int k = 0; k < 200; k++) {
        /* The other thread may have freed it: then the status says so. */
        int status = qless_expand(handle, masters, 1, u, 3);
        NEED(status == QLESS_INPUT || (status == QLESS_OK && u[0] == 1));
        qless_refresh(handle, rhs, 2, NULL, 0);
        qless_multipliers(handle, u, 3, lambda, 2);
    }
    qless_elimination_free(handle);
    return NULL;
}

static void *condense(void *handle)
{
    double k_q[1], f_q[1];
    for (int n = 0; n < 200; n++) {
        int status = qless_condense(handle, k, 7, f, 3, k_q, 1, f_q, 1);
        NEED(status == QLESS_INPUT || (status == QLESS_OK && k_q[0] == 2 && f_q[0] == 3));
    }
    qless_pattern_free(handle);
    return NULL;
}

static void two_threads(void)
{
    qless_analysis *analysis = analysed(NULL);
    qless_elimination *elimination = NULL;
    qless_pattern *pattern = NULL;
    pthread_t thread;
    NEED(qless_eliminate(analysis, &elimination) == QLESS_OK);
    NEED(qless_condensed(elimination, 3, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, k_starts, k_index, &pattern) == QLESS_OK);
    NEED(pthread_create(&thread, NULL, condense, pattern) == 0);
    condense(pattern);
    pthread_join(thread, NULL);
    NEED(pthread_create(&thread, NULL, use, elimination) == 0);
    use(elimination);
    pthread_join(thread, NULL);
    NEED(qless_analysis_free(analysis) == QLESS_OK);
}

int main(void)
{
    NEED(strcmp(qless_version(), "") != 0 && strcmp(qless_message(), "") == 0);
    bad_systems();
    bad_handles();
    bad_options();
    conflicts();
    bad_patterns();
    bad_elements();
    bad_questions();
    bad_decks();
    two_threads();
    puts("misuse: every call returned");
    return 0;
}
