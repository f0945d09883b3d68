// A P = Q R and Q^T B by LAPACK's dgeqp3 and dormqr: dense QR with column pivoting.
#define _POSIX_C_SOURCE 199309L
#include <stdlib.h>
#include <time.h>

void dgeqp3_(const int *m, const int *n, double *a, const int *lda, int *jpvt, double *tau, double *work, const int *lwork,
             int *info);
void dormqr_(const char *side, const char *trans, const int *m, const int *n, const int *k, const double *a,
             const int *lda, const double *tau, double *c, const int *ldc, double *work, const int *lwork, int *info,
             size_t side_length, size_t trans_length);

enum { QLESS_DONE = 0, QLESS_NO_MEMORY = 1, QLESS_FAILED = 2 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// R over the reflectors in A (m x n by columns), P in `order` (length n, from 1), the factors of the reflectors in `tau`.
int qless_lapack_factor(int m, int n, double *a, int *order, double *tau, double *seconds) {
    double from = now();
    int info = 0, query = -1;
    double best = 0;
    for (int j = 0; j < n; j++) order[j] = 0;
    dgeqp3_(&m, &n, a, &m, order, tau, &best, &query, &info);
    if (info != 0) return QLESS_FAILED;
    int size = (int)best;
    double *work = malloc(sizeof(double) * (size_t)size);
    if (work == NULL) return QLESS_NO_MEMORY;
    dgeqp3_(&m, &n, a, &m, order, tau, work, &size, &info);
    free(work);
    *seconds = now() - from;
    return info == 0 ? QLESS_DONE : QLESS_FAILED;
}

// B (m x k by columns) becomes Q^T B, of the first `rank` reflectors.
int qless_lapack_apply(int m, int rank, const double *a, const double *tau, int k, double *b, double *seconds) {
    double from = now();
    int info = 0, query = -1;
    double best = 0;
    dormqr_("L", "T", &m, &k, &rank, a, &m, tau, b, &m, &best, &query, &info, 1, 1);
    if (info != 0) return QLESS_FAILED;
    int size = (int)best;
    double *work = malloc(sizeof(double) * (size_t)size);
    if (work == NULL) return QLESS_NO_MEMORY;
    dormqr_("L", "T", &m, &k, &rank, a, &m, tau, b, &m, work, &size, &info, 1, 1);
    free(work);
    *seconds = now() - from;
    return info == 0 ? QLESS_DONE : QLESS_FAILED;
}
