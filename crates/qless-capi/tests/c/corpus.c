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
#define FORMAT SCNd64
#else
typedef int32_t integer;
#define ANALYSE qless_analyse
#define DOFS qless_dofs
#define T qless_t
#define G qless_g_matrix
#define EXPLANATION qless_explanation
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
            print_elimination(elimination, m, n);
        need(qless_elimination_free(elimination)), need(qless_analysis_free(analysis));
        free(starts), free(columns), free(values), free(rhs), free(dofs), free(given), free(kinds);
    }
    return 0;
}
