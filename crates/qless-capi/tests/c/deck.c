/* Reads the decks whose paths are on standard input, prints what the library finds in each, and cleans it to <path>.clean. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "qless.h"

static int need(int status)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", qless_message());
        exit(1);
    }
    return status;
}

static char text[1000];

static uint64_t bits(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static const char *label(const qless_analysis *analysis, int what, int64_t index)
{
    int64_t length;
    need(qless_label(analysis, what, index, NULL, 0, &length));
    need(qless_label(analysis, what, index, text, sizeof text, &length));
    return text;
}

static void print_reason(const qless_analysis *analysis, int what, int64_t index)
{
    qless_member members[100];
    double rhs;
    int irreducible;
    int64_t count;
    need(qless_reason(analysis, what, index, members, 100, &rhs, &irreducible, &count));
    printf("reason %d %" PRId64 " %016" PRIx64 " %d", what, index, bits(rhs), irreducible);
    for (int64_t k = 0; k < count; k++)
        printf(" %" PRId64 ":%" PRId64 ":%016" PRIx64, members[k].what, members[k].index, bits(members[k].coefficient));
    puts("");
}

static void print_repairs(const qless_analysis *analysis)
{
    int64_t groups, conflicts, ways, length;
    need(qless_repairs(analysis, &groups));
    for (int64_t g = 1; g <= groups; g++) {
        need(qless_repair_sizes(analysis, g, &conflicts, &ways, &length));
        int64_t *rows = malloc(conflicts * sizeof *rows);
        qless_change *changes = malloc((length + 1) * sizeof *changes);
        need(qless_repair_conflicts(analysis, g, rows, conflicts));
        printf("repair");
        for (int64_t k = 0; k < conflicts; k++)
            printf(" %" PRId64, rows[k]);
        puts("");
        for (int64_t w = 1; w <= ways; w++) {
            need(qless_repair(analysis, g, w, changes, length));
            printf("way");
            for (int64_t k = 0; k < length; k++)
                printf(" %" PRId64 ":%" PRId64 ":%016" PRIx64 ":%016" PRIx64, changes[k].what, changes[k].index, bits(changes[k].from),
                       bits(changes[k].to));
            puts("");
        }
        free(rows), free(changes);
    }
}

static void print_analysis(const qless_analysis *analysis)
{
    int64_t equations, dofs, rank, redundant, conflicting, count, length;
    int doubt;
    need(qless_counts(analysis, &equations, &dofs, &rank, &redundant, &conflicting));
    printf("rank %" PRId64 " %" PRId64 " %" PRId64 "\n", rank, redundant, conflicting);
    for (int64_t i = 1; i <= equations; i++)
        printf("equation %s\n", label(analysis, QLESS_EQUATION, i)), print_reason(analysis, QLESS_EQUATION, i);
    for (int64_t j = 1; j <= dofs; j++)
        printf("dof %s", label(analysis, QLESS_DOF, j)), printf(" at %s\n", label(analysis, QLESS_PRESCRIBED, j));
    int32_t *fixed = malloc((dofs + 1) * sizeof *fixed);
    double *values = malloc((dofs + 1) * sizeof *values);
    need(qless_fixed(analysis, NULL, NULL, 0, &count));
    need(qless_fixed(analysis, fixed, values, count, &count));
    for (int64_t k = 0; k < count; k++)
        printf("fixed %d %016" PRIx64 "\n", (int)fixed[k], bits(values[k])), print_reason(analysis, QLESS_DOF, fixed[k]);
    free(fixed), free(values);
    need(qless_doubt(analysis, &doubt, text, sizeof text, &length));
    printf("doubt %d %s\n", doubt, text);
    print_repairs(analysis);
}

int main(void)
{
    char path[1000], target[1100];
    int64_t equations, cases, warnings, left_out, removed, written, length;
    while (fgets(path, sizeof path, stdin)) {
        path[strcspn(path, "\n")] = '\0';
        qless_deck *deck = NULL;
        int status = qless_deck_read(path, NULL, 1, &deck);
        if (status < 0) {
            printf("error %d %s\n", status, qless_message());
            continue;
        }
        need(qless_deck_counts(deck, &equations, &cases, &warnings, &left_out));
        printf("deck %d %" PRId64 " %" PRId64 "\n", status, equations, left_out);
        for (int64_t w = 1; w <= warnings; w++)
            need(qless_deck_warning(deck, w, text, sizeof text, &length)), printf("warning %s\n", text);
        for (int64_t c = 1; c <= cases; c++) {
            qless_analysis *analysis = NULL;
            need(qless_deck_load_case(deck, c, text, sizeof text, &length));
            printf("case %s\n", text);
            need(qless_deck_analyse(deck, c, NULL, &analysis));
            print_analysis(analysis);
            need(qless_analysis_free(analysis));
        }
        snprintf(target, sizeof target, "%s.clean", path);
        status = qless_deck_clean(deck, NULL, target, &removed, &written);
        if (status < 0)
            printf("clean %d %s\n", status, qless_message());
        else
            printf("clean %d %" PRId64 " %" PRId64 "\n", status, removed, written);
        need(qless_deck_free(deck));
    }
    return 0;
}
