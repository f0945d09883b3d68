/* Equations in the arrays of CalculiX: equation i starts at the term ipompc[i] - 1; a term k has the node nodempc[3k], its direction
 * nodempc[3k + 1] and the number of the next term nodempc[3k + 2], from 1, 0 for the last one; coefmpc[k] is its coefficient. The first
 * term is the slave. ccx stops if two equations have one slave. Here they become independent equations with distinct slaves. */
#include <stdio.h>
#include <stdlib.h>

#include "qless.h"

enum { NODES = 4, DIRECTIONS = 3, EQUATIONS = 3 };

static void need(int status)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", qless_message());
        exit(1);
    }
}

/* Writes u_s - sum T u_q = 0 for every slave; returns the number of equations. */
static int write_back(const qless_elimination *elimination, int *ipompc, int *nodempc, double *coefmpc)
{
    int64_t slaves, masters, prescribed, entries, of_g;
    need(qless_sizes(elimination, &slaves, &masters, &prescribed, &entries, &of_g));
    int32_t *s = malloc(slaves * sizeof *s), *q = malloc(masters * sizeof *q);
    int32_t *starts = malloc((slaves + 1) * sizeof *starts), *columns = malloc(entries * sizeof *columns);
    double *t = malloc(entries * sizeof *t);
    need(qless_dofs(elimination, s, q, NULL));
    need(qless_t(elimination, starts, columns, t));
    int term = 0;
    for (int i = 0; i < slaves; i++) {
        ipompc[i] = term + 1;
        for (int k = starts[i] - 1; k <= starts[i + 1] - 1; k++, term++) { /* the slave, then its masters */
            int is_slave = k == starts[i] - 1;
            int dof = (is_slave ? s[i] : q[columns[k - 1] - 1]) - 1;
            nodempc[3 * term] = dof / DIRECTIONS + 1;
            nodempc[3 * term + 1] = dof % DIRECTIONS + 1;
            nodempc[3 * term + 2] = k == starts[i + 1] - 1 ? 0 : term + 2;
            coefmpc[term] = is_slave ? 1 : -t[k - 1];
        }
    }
    free(s), free(q), free(starts), free(columns), free(t);
    return (int)slaves;
}

int main(void)
{
    /* u1 = u2, u1 = u3, u2 = u3 in direction 1: 1:1 is the slave of two equations, and the third says nothing new. */
    int ipompc[EQUATIONS] = {1, 3, 5};
    int nodempc[] = {1, 1, 2, 2, 1, 0, 1, 1, 4, 3, 1, 0, 2, 1, 6, 3, 1, 0};
    double coefmpc[] = {1, -1, 1, -1, 1, -1};

    int32_t starts[EQUATIONS + 1], columns[6];
    double values[6];
    int entries = 0;
    for (int i = 0; i < EQUATIONS; i++) {
        starts[i] = entries + 1;
        for (int k = ipompc[i]; k != 0; k = nodempc[3 * (k - 1) + 2], entries++) {
            columns[entries] = (nodempc[3 * (k - 1)] - 1) * DIRECTIONS + nodempc[3 * (k - 1) + 1];
            values[entries] = coefmpc[k - 1];
        }
    }
    starts[EQUATIONS] = entries + 1;

    qless_analysis *analysis = NULL;
    qless_elimination *elimination = NULL;
    need(qless_analyse(EQUATIONS, NODES * DIRECTIONS, 1, starts, columns, values, NULL, 0, NULL, NULL, NULL, &analysis));
    need(qless_eliminate(analysis, &elimination));
    int count = write_back(elimination, ipompc, nodempc, coefmpc);
    for (int i = 0; i < count; i++)
        for (int k = ipompc[i]; k != 0; k = nodempc[3 * (k - 1) + 2])
            printf("%s%g * %d:%d", k == ipompc[i] ? "" : " ", coefmpc[k - 1], nodempc[3 * (k - 1)], nodempc[3 * (k - 1) + 1]),
                nodempc[3 * (k - 1) + 2] == 0 ? puts("") : 0;
    need(qless_elimination_free(elimination));
    need(qless_analysis_free(analysis));
    return 0;
}
