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
    NEED(qless_analyse(2, 3, 0, (const int32_t *)((const char *)starts + 1), columns, values, NULL, 0, NULL, NULL, NULL, &analysis) == QLESS_INPUT);
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
    const double rhs[] = {0, 1}, same[] = {2, 2};
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
    NEED(qless_refresh(elimination, same, 2, NULL, 0) == QLESS_OK);
    NEED(qless_g(elimination, g, 1) == QLESS_OK && fabs(g[0]) == 2);
    NEED(qless_analysis_free(analysis) == QLESS_OK && qless_elimination_free(elimination) == QLESS_OK);
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

static void two_threads(void)
{
    qless_analysis *analysis = analysed(NULL);
    qless_elimination *elimination = NULL;
    pthread_t thread;
    NEED(qless_eliminate(analysis, &elimination) == QLESS_OK);
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
    two_threads();
    puts("misuse: every call returned");
    return 0;
}
