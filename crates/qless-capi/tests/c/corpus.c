/* Reads systems from standard input and writes all results as hexadecimal numbers, which Rust compares with its own. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "qless.h"

#ifdef WIDE
typedef int64_t integer;
#define ANALYSE qless_analyse_64
#define DOFS qless_dofs_64
#define T qless_t_64
#define G qless_g_matrix_64
#define EXPLANATION qless_explanation_64
#define CONDENSED qless_condensed_64
#define ARRAYS qless_pattern_arrays_64
#define FORMAT SCNd64
#else
typedef int32_t integer;
#define ANALYSE qless_analyse
#define DOFS qless_dofs
#define T qless_t
#define G qless_g_matrix
#define EXPLANATION qless_explanation
#define CONDENSED qless_condensed
#define ARRAYS qless_pattern_arrays
#define FORMAT SCNd32
#endif

static void need(int status)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", qless_message());
        exit(1);
    }
}

static integer *integers(int64_t count)
{
    integer *list = malloc((count + 1) * sizeof *list);
    return list;
}

static double *numbers(int64_t count)
{
    double *list = malloc((count + 1) * sizeof *list);
    return list;
}

static integer *read_integers(int64_t count)
{
    integer *list = integers(count);
    for (int64_t k = 0; k < count; k++)
        if (scanf("%" FORMAT, list + k) != 1)
            exit(2);
    return list;
}

static double *read_numbers(int64_t count)
{
    double *list = numbers(count);
    for (int64_t k = 0; k < count; k++)
        if (scanf("%la", list + k) != 1)
            exit(2);
    return list;
}

static void print_integers(const char *name, const integer *list, int64_t count)
{
    printf("%s", name);
    for (int64_t k = 0; k < count; k++)
        printf(" %" PRId64, (int64_t)list[k]);
    printf("\n");
}

static void print_numbers(const char *name, const double *list, int64_t count)
{
    printf("%s", name);
    for (int64_t k = 0; k < count; k++) {
        union {
            double number;
            uint64_t bits;
        } one = {.number = list[k]};
        printf(" %016" PRIx64, one.bits);
    }
    printf("\n");
}

static void print_elimination(const qless_elimination *e, int64_t equations, int64_t n)
{
    int64_t ns, nq, np, nt, ng;
    need(qless_sizes(e, &ns, &nq, &np, &nt, &ng));
    integer *s = integers(ns), *q = integers(nq), *starts = integers(ns + 1), *columns = integers(nt > ng ? nt : ng);
    double *values = numbers(nt > ng ? nt : ng), *u = numbers(n), *x = numbers(nq), *lambda = numbers(equations);
    need(DOFS(e, s, q, NULL));
    print_integers("slaves", s, ns), print_integers("masters", q, nq);
    need(T(e, starts, columns, values));
    print_integers("starts", starts, ns + 1), print_integers("columns", columns, nt), print_numbers("T", values, nt);
    need(G(e, starts, columns, values));
    print_numbers("G", values, ng);
    need(qless_g(e, values = realloc(values, (ns + 1) * sizeof *values), ns));
    print_numbers("g", values, ns);
    for (int64_t k = 0; k < nq; k++)
        x[k] = 1.0 / (double)(k + 1);
    need(qless_expand(e, x, nq, u, n));
    print_numbers("u", u, n);
    need(qless_restrict(e, u, n, x, nq));
    print_numbers("restricted", x, nq);
    need(qless_multipliers(e, u, n, lambda, equations));
    print_numbers("multipliers", lambda, equations);
    free(s), free(q), free(starts), free(columns), free(values), free(u), free(x), free(lambda);
}

/* K has 2 + i on its diagonal and -1 above it, and f_i = i. */
static void print_condensed(const qless_elimination *e, int64_t n, int base)
{
    int64_t nq, entries;
    integer *starts = integers(n + 1), *index = integers(2 * n);
    double *k = numbers(2 * n), *f = numbers(n);
    for (int64_t i = 0; i < n; i++) {
        starts[i] = (integer)(2 * i + base);
        index[2 * i] = (integer)(i + base), k[2 * i] = 2.0 + (double)i;
        index[2 * i + 1] = (integer)(i + 1 < n ? i + 1 + base : i + base), k[2 * i + 1] = -1;
        f[i] = (double)i;
    }
    starts[n] = (integer)(2 * n + base);
    qless_pattern *pattern = NULL;
    need(CONDENSED(e, n, QLESS_ROWS, QLESS_FULL, QLESS_ELIMINATED, starts, index, &pattern));
    need(qless_pattern_sizes(pattern, &nq, &entries));
    integer *of_q = integers(nq + 1), *columns = integers(entries), *dofs = integers(nq);
    double *k_q = numbers(entries), *f_q = numbers(nq);
    need(ARRAYS(pattern, of_q, columns, dofs));
    need(qless_condense(pattern, k, 2 * n, f, n, k_q, entries, f_q, nq));
    print_integers("lines", of_q, nq + 1), print_integers("index", columns, entries), print_integers("unknowns", dofs, nq);
    print_numbers("K_q", k_q, entries), print_numbers("f_q", f_q, nq);
    need(qless_pattern_free(pattern));
    free(starts), free(index), free(k), free(f), free(of_q), free(columns), free(dofs), free(k_q), free(f_q);
}

int main(void)
{
    int64_t m, n, nnz, count;
    int base;
    while (scanf("%" SCNd64 "%" SCNd64 "%" SCNd64 "%" SCNd64 "%d", &m, &n, &nnz, &count, &base) == 5) {
        integer *starts = read_integers(m + 1), *columns = read_integers(nnz);
        double *values = read_numbers(nnz), *rhs = read_numbers(m);
        integer *dofs = read_integers(count);
        double *given = read_numbers(count), digits[2];
        qless_analysis *analysis = NULL;
        need(ANALYSE(m, n, base, starts, columns, values, rhs, count, dofs, given, NULL, &analysis));
        int64_t equations, all, rank, redundant, conflicting, terms;
        int ambiguous;
        need(qless_counts(analysis, &equations, &all, &rank, &redundant, &conflicting));
        need(qless_digits(analysis, digits, digits + 1, &ambiguous));
        printf("rank %" PRId64 " %" PRId64 " %" PRId64 " %d\n", rank, redundant, conflicting, ambiguous);
        print_numbers("digits", digits, 2);
        int8_t *kinds = malloc(m + 1);
        need(qless_kinds(analysis, kinds, m));
        for (int64_t i = 0; i < m; i++) {
            if (kinds[i] == QLESS_INDEPENDENT)
                continue;
            need(EXPLANATION(analysis, i + base, NULL, NULL, 0, &terms));
            integer *rows = integers(terms);
            double *coefficients = numbers(terms);
            need(EXPLANATION(analysis, i + base, rows, coefficients, terms, &terms));
            print_integers("because", rows, terms), print_numbers("coefficients", coefficients, terms);
            free(rows), free(coefficients);
        }
        qless_elimination *elimination = NULL;
        if (qless_eliminate(analysis, &elimination) == QLESS_OK)
            print_elimination(elimination, m, n), print_condensed(elimination, n, base);
        need(qless_elimination_free(elimination)), need(qless_analysis_free(analysis));
        free(starts), free(columns), free(values), free(rhs), free(dofs), free(given), free(kinds);
    }
    return 0;
}
