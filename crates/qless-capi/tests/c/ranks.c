/* Rings of ties and sums over DOFs of all ranks. Rank 0 prints the kinds and the rows of T, G and g as the ranks found them, and as
 * qless_analyse does for all equations. Conflicts, misuse, and functions that fail are errors on all ranks. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "qless_mpi.h"

#define NEED(condition)                                                                                            \
    do {                                                                                                           \
        if (!(condition)) {                                                                                        \
            fprintf(stderr, "rank %d, line %d: %s (%s)\n", world.rank, __LINE__, #condition, qless_message());      \
            MPI_Abort(MPI_COMM_WORLD, 1);                                                                          \
        }                                                                                                          \
    } while (0)

enum { RING = 24, SUMS = 6, N = RING + 2 * SUMS, ROWS = RING + SUMS + 1, ROOM = 1 << 14 };

static MPI_Comm communicator;
static qless_ranks world;

/* Equations of this rank, or all of them. */
typedef struct rows {
    int64_t count, numbers[ROWS], starts[ROWS + 1], columns[4 * ROWS];
    double values[4 * ROWS], rhs[ROWS];
} rows;

static double u(int64_t dof)
{
    return (double)(dof * 5 % 7) - 3;
}

static void add(rows *to, int64_t number, int count, const int64_t *columns, const double *values, double off)
{
    int64_t end = to->starts[to->count];
    to->numbers[to->count] = number;
    to->rhs[to->count] = off;
    for (int k = 0; k < count; k++) {
        to->columns[end + k] = columns[k];
        to->values[end + k] = values[k];
        to->rhs[to->count] += values[k] * u(columns[k]);
    }
    to->starts[++to->count] = end + count;
}

/* Two rings of ties, over the even and the odd DOFs; sums of three DOFs; a copy of the first sum. off: the fault of the copy. */
static void equation(rows *to, int64_t k, double off)
{
    if (k < RING) {
        int64_t columns[] = {k, (k + 2) % RING};
        double values[] = {1, k / 2 % 2 == 0 ? -2 : -0.5};
        add(to, k, 2, columns, values, 0);
    } else {
        int64_t i = (k - RING) % SUMS, columns[] = {RING + i, i, RING + SUMS + i};
        double values[] = {1, -0.3, -0.7};
        add(to, k, 3, columns, values, k == ROWS - 1 ? off : 0);
    }
}

/* Equations go round the ranks, so that most have DOFs of other ranks. */
static rows part(int rank, int size, double off)
{
    rows mine = {0};
    for (int64_t k = 0; k < ROWS; k++)
        if (k % size == rank)
            equation(&mine, k, off);
    return mine;
}

static int64_t first_of(int rank)
{
    return (int64_t)N * rank / world.size;
}

/* u_4 is prescribed. */
static int analysed(const qless_ranks *ranks, const rows *mine, qless_distributed **found)
{
    const int64_t dof = 4, base = 0;
    const double value = u(4);
    return qless_analyse_ranks(ranks, (int)base, first_of(world.rank), first_of(world.rank + 1), mine->count, mine->numbers, mine->starts,
                               mine->columns, mine->values, mine->rhs, world.rank == 0, &dof, &value, 0, NULL, NULL, found);
}

static char text[ROOM];

static void say(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    size_t end = strlen(text);
    int length = vsnprintf(text + end, ROOM - end, format, list);
    NEED(length >= 0 && (size_t)length < ROOM - end);
    va_end(list);
}

/* Rows of slaves between first and end, with DOFs as dofs numbers them (null: as they are). */
static void say_reduced(const char *name, const qless_elimination *found, const int64_t *dofs, int64_t first, int64_t end)
{
    int64_t n[5], s[N], q[N], p[N], starts[N + 1], columns[N * 4], g_starts[N + 1], g_columns[N * 4];
    double values[N * 4], g_values[N * 4], g[N];
    NEED(qless_sizes(found, n, n + 1, n + 2, n + 3, n + 4) == QLESS_OK && n[3] <= N * 4 && n[4] <= N * 4);
    NEED(qless_dofs_64(found, s, q, p) == QLESS_OK && qless_t_64(found, starts, columns, values) == QLESS_OK);
    NEED(qless_g_matrix_64(found, g_starts, g_columns, g_values) == QLESS_OK && qless_g(found, g, n[0]) == QLESS_OK);
    for (int64_t i = 0; i < n[0]; i++) {
        int64_t slave = dofs ? dofs[s[i]] : s[i];
        if (slave < first || slave >= end)
            continue;
        say("%s: u%d = %a", name, (int)slave, g[i]);
        for (int64_t k = starts[i]; k < starts[i + 1]; k++)
            say(" + %a u%d", values[k], (int)(dofs ? dofs[q[columns[k]]] : q[columns[k]]));
        for (int64_t k = g_starts[i]; k < g_starts[i + 1]; k++)
            say(" + %a given u%d", g_values[k], (int)(dofs ? dofs[p[g_columns[k]]] : p[g_columns[k]]));
        say("\n");
    }
}

static void say_kinds(const char *name, const rows *of, const int8_t *kinds)
{
    for (int64_t i = 0; i < of->count; i++)
        say("%s: equation %d is %d\n", name, (int)of->numbers[i], kinds[i]);
}

static void serial(void)
{
    rows all = part(0, 1, 0);
    int8_t kinds[ROWS];
    const int64_t dof = 4;
    const double value = u(4);
    qless_analysis *analysis = NULL;
    qless_elimination *found = NULL;
    NEED(qless_analyse_64(all.count, N, 0, all.starts, all.columns, all.values, all.rhs, 1, &dof, &value, NULL, &analysis) == QLESS_OK);
    NEED(qless_kinds(analysis, kinds, all.count) == QLESS_OK && qless_eliminate(analysis, &found) == QLESS_OK);
    say_kinds("serial", &all, kinds);
    say_reduced("serial", found, NULL, 0, N);
    int64_t n;
    NEED(qless_distributed_dofs(found, NULL, 0, &n) == QLESS_INPUT && strstr(qless_message(), "qless_distributed_eliminate"));
    NEED(qless_elimination_free(found) == QLESS_OK && qless_analysis_free(analysis) == QLESS_OK);
}

/* Local masters get the values of u; then all local DOFs have them. */
static void check_expansion(qless_elimination *found, const int64_t *dofs, int64_t count)
{
    int64_t n[5], q[N], own[N], owned;
    double masters[N], all[N];
    NEED(qless_sizes(found, n, n + 1, n + 2, n + 3, n + 4) == QLESS_OK && qless_dofs_64(found, NULL, q, NULL) == QLESS_OK);
    for (int64_t k = 0; k < n[1]; k++)
        masters[k] = u(dofs[q[k]]);
    NEED(qless_expand(found, masters, n[1], all, count) == QLESS_OK);
    for (int64_t j = 0; j < count; j++)
        NEED(all[j] - u(dofs[j]) < 1e-12 && u(dofs[j]) - all[j] < 1e-12);
    NEED(qless_distributed_masters(found, own, N, &owned) == QLESS_OK && owned <= n[1]);
    for (int64_t k = 0; k < owned; k++)
        NEED(own[k] >= first_of(world.rank) && own[k] < first_of(world.rank + 1));
    NEED(qless_refresh(found, NULL, 0, NULL, 0) < 0);
    NEED(qless_multipliers(found, all, count, masters, 0) < 0);
}

static void distributed(void)
{
    rows mine = part(world.rank, world.size, 0);
    int8_t kinds[ROWS];
    int64_t n[5], dofs[N], count, numbers[ROWS];
    double coefficients[ROWS];
    qless_distributed *analysis = NULL;
    qless_elimination *found = NULL;
    NEED(analysed(&world, &mine, &analysis) == QLESS_OK);
    NEED(qless_distributed_counts(analysis, n, n + 1, n + 2, n + 3, n + 4) == QLESS_OK);
    NEED(n[0] == ROWS && n[1] == N && n[2] == ROWS - 3 && n[3] == 3 && n[4] == 0);
    NEED(qless_distributed_kinds(analysis, kinds, mine.count) == QLESS_OK);
    say_kinds("ranks", &mine, kinds);
    for (int64_t i = 0; i < mine.count; i++) {
        NEED(qless_distributed_explanation(analysis, i, numbers, coefficients, ROWS, &count) == QLESS_OK);
        NEED((count > 0) == (kinds[i] != QLESS_INDEPENDENT));
        NEED(mine.numbers[i] != ROWS - 1 || (count == 1 && numbers[0] == RING && coefficients[0] == 1));
    }
    NEED(qless_distributed_eliminate(&world, analysis, &found) == QLESS_OK);
    NEED(qless_distributed_dofs(found, dofs, N, &count) == QLESS_OK);
    say_reduced("ranks", found, dofs, first_of(world.rank), first_of(world.rank + 1));
    check_expansion(found, dofs, count);
    NEED(qless_distributed_kinds(analysis, kinds, mine.count + 1) == QLESS_INPUT);
    NEED(qless_distributed_kinds(analysis, NULL, mine.count) == QLESS_INPUT);
    NEED(qless_distributed_explanation(analysis, mine.count, numbers, coefficients, ROWS, &count) == QLESS_INPUT);
    NEED(qless_distributed_dofs(found, dofs, 1, &count) == QLESS_INPUT && qless_distributed_dofs(found, dofs, N, NULL) == QLESS_INPUT);
    NEED(qless_elimination_free(found) == QLESS_OK && qless_distributed_free(analysis) == QLESS_OK);
}

/* A copy on one rank contradicts its original: every rank hears of it. */
static void conflict(void)
{
    rows mine = part(world.rank, world.size, 1);
    int64_t n[5];
    qless_distributed *analysis = NULL;
    qless_elimination *found = NULL;
    NEED(analysed(&world, &mine, &analysis) == QLESS_OK);
    NEED(qless_distributed_counts(analysis, n, n + 1, n + 2, n + 3, n + 4) == QLESS_OK && n[3] == 2 && n[4] == 1);
    NEED(qless_distributed_eliminate(&world, analysis, &found) == QLESS_CONFLICT && found == NULL);
    NEED(strstr(qless_message(), "among them equation 30"));
    NEED(qless_distributed_free(analysis) == QLESS_OK);
}

/* An argument that is not valid on the last rank only, and a handle that is freed there: all ranks return the same. */
static void fault_on_one_rank(void)
{
    int is_last = world.rank == world.size - 1;
    rows mine = part(world.rank, world.size, 0);
    char begin[24];
    snprintf(begin, sizeof begin, "rank %d: ", world.size - 1);
    qless_distributed *analysis = NULL, *gone = NULL;
    qless_elimination *found = NULL;
    int64_t columns = mine.columns[0], number = mine.numbers[0];
    mine.columns[0] = is_last ? -1 : columns;
    NEED(analysed(&world, &mine, &analysis) == QLESS_INPUT && strstr(qless_message(), begin));
    mine.columns[0] = is_last ? N : columns;
    NEED(analysed(&world, &mine, &analysis) == QLESS_INPUT && strstr(qless_message(), begin));
    mine.columns[0] = columns;
    mine.numbers[0] = is_last ? mine.numbers[1] : number;
    NEED(analysed(&world, &mine, &analysis) == QLESS_INPUT && strstr(qless_message(), "used twice"));
    mine.numbers[0] = number;
    mine.count = is_last ? -1 : mine.count;
    NEED(analysed(&world, &mine, &analysis) == QLESS_INPUT && strstr(qless_message(), begin));
    mine.count = part(world.rank, world.size, 0).count;
    NEED(analysed(&world, &mine, is_last ? NULL : &analysis) == QLESS_INPUT && strstr(qless_message(), begin) && analysis == NULL);
    NEED(analysed(&world, &mine, &analysis) == QLESS_OK);
    NEED(qless_distributed_eliminate(&world, analysis, is_last ? NULL : &found) == QLESS_INPUT && strstr(qless_message(), begin));
    NEED(!is_last || qless_distributed_free(analysis) == QLESS_OK);
    NEED(qless_distributed_eliminate(&world, analysis, &found) == QLESS_INPUT && strstr(qless_message(), begin));
    NEED(found == NULL && (is_last || qless_distributed_free(analysis) == QLESS_OK));
    NEED(qless_distributed_free(analysis) == QLESS_INPUT && qless_distributed_free(NULL) == QLESS_OK);
    NEED(qless_distributed_kinds(analysis, NULL, 0) == QLESS_INPUT && qless_distributed_kinds(gone, NULL, 0) == QLESS_INPUT);
}

/* Functions that return 7 when the count of calls is used up. */
static int left;

static int exchange(void *context, const uint64_t *sent, const int64_t *sent_counts, uint64_t *received, const int64_t *received_counts)
{
    return left-- == 0 ? 7 : qless_mpi_exchange(context, sent, sent_counts, received, received_counts);
}

static int reduce(void *context, uint64_t *numbers, int64_t count, int is_max)
{
    return left-- == 0 ? 7 : qless_mpi_reduce(context, numbers, count, is_max);
}

static int gather(void *context, const uint64_t *numbers, int64_t count, uint64_t *all)
{
    return left-- == 0 ? 7 : qless_mpi_gather(context, numbers, count, all);
}

/* Each call fails once, on all ranks at the same place. */
static void failing_functions(void)
{
    rows mine = part(world.rank, world.size, 0);
    qless_ranks failing = world;
    failing.exchange = exchange, failing.reduce = reduce, failing.gather = gather;
    int calls = -1, status = QLESS_RANKS;
    while (status == QLESS_RANKS) {
        qless_distributed *analysis = NULL;
        qless_elimination *found = NULL;
        left = ++calls;
        status = analysed(&failing, &mine, &analysis);
        if (status == QLESS_OK)
            status = qless_distributed_eliminate(&failing, analysis, &found);
        NEED(status == QLESS_OK || (status == QLESS_RANKS && found == NULL && strstr(qless_message(), "of ranks returned 7")));
        NEED(qless_elimination_free(found) == QLESS_OK && qless_distributed_free(analysis) == QLESS_OK);
    }
    NEED(calls > 20);
}

/* Says that it received as many words as no memory has. */
static int lie(void *context, const uint64_t *sent, const int64_t *sent_counts, uint64_t *received, const int64_t *received_counts)
{
    (void)context, (void)sent, (void)sent_counts;
    for (int64_t rank = 0, place = 0; rank < world.size; rank++)
        for (int64_t k = 0; k < received_counts[rank]; k++)
            received[place++] = UINT64_MAX;
    return 0;
}

static void bad_ranks(void)
{
    rows mine = part(world.rank, world.size, 0);
    qless_distributed *analysis = NULL;
    qless_ranks bad[5] = {world, world, world, world, world};
    bad[0].exchange = NULL, bad[1].reduce = NULL, bad[2].gather = NULL, bad[3].rank = world.size, bad[4].rank = -1;
    for (int k = 0; k < 5; k++)
        NEED(analysed(bad + k, &mine, &analysis) == QLESS_INPUT && analysis == NULL);
    NEED(analysed(NULL, &mine, &analysis) == QLESS_INPUT && strstr(qless_message(), "ranks is no address"));
    bad[0].exchange = lie;
    NEED(analysed(bad, &mine, &analysis) == QLESS_RANKS && strstr(qless_message(), "more words than this rank has memory for"));
    NEED(qless_distributed_eliminate(NULL, analysis, NULL) == QLESS_INPUT);
    int64_t many[2] = {INT32_MAX, 1};
    int counts[2], places[2];
    NEED(qless_mpi_places(1, many, counts, places) == 0 && qless_mpi_places(2, many, counts, places) == QLESS_MPI_TOO_MANY);
    NEED(qless_mpi_reduce(&communicator, NULL, 1 + (int64_t)INT32_MAX, 0) == QLESS_MPI_TOO_MANY);
    NEED(qless_mpi_gather(&communicator, NULL, 1 + (int64_t)INT32_MAX, NULL) == QLESS_MPI_TOO_MANY);
}

/* Rank 0 prints the texts of all. */
static void print_all(void)
{
    char *all = malloc((size_t)ROOM * (size_t)world.size);
    NEED(all != NULL && MPI_Gather(text, ROOM, MPI_CHAR, all, ROOM, MPI_CHAR, 0, communicator) == MPI_SUCCESS);
    for (int rank = 0; world.rank == 0 && rank < world.size; rank++)
        printf("%s", all + (size_t)ROOM * (size_t)rank);
    free(all);
}

int main(int argc, char **argv)
{
    MPI_Init(&argc, &argv);
    communicator = MPI_COMM_WORLD;
    NEED(qless_mpi_ranks(&communicator, &world) == 0);
    if (world.rank == 0)
        serial();
    distributed();
    conflict();
    fault_on_one_rank();
    bad_ranks();
    failing_functions();
    print_all();
    return MPI_Finalize();
}
