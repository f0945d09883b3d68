/* Makes the equations of CalculiX independent, in its own arrays. An equation i starts at the term ipompc[i] - 1. A term k has the node
 * nodempc[3k], its direction nodempc[3k + 1] and the number of the next term nodempc[3k + 2], from 1, 0 for the last one; coefmpc[k] is its
 * coefficient. The first term is the slave; ikmpc has the slaves 8 (node - 1) + direction, ascending, and ilmpc their equations. ccx stops
 * if two equations have one slave, or if a slave is prescribed. */
#include <stdio.h>
#include <stdlib.h>

#include "qless.h"

static void need(int status)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", qless_message());
        exit(1);
    }
}

typedef struct {
    int nmpc, memmpc, *ipompc, *nodempc, *ikmpc, *ilmpc; /* memmpc: room of nodempc (three times) and coefmpc */
    double *coefmpc;
} mpcs;

static qless_elimination *eliminated(int nk, const mpcs *m, int nboun, const int *nodeboun, const int *ndirboun, const double *xboun)
{
    int32_t *starts = malloc((m->nmpc + 1) * sizeof *starts), *columns = malloc(m->memmpc * sizeof *columns);
    int32_t *given = malloc((nboun + 1) * sizeof *given);
    double *values = malloc(m->memmpc * sizeof *values);
    int entries = 0;
    for (int i = 0; i < m->nmpc; i++) {
        starts[i] = entries;
        for (int k = m->ipompc[i]; k != 0; k = m->nodempc[3 * k - 1], entries++) {
            columns[entries] = 8 * (m->nodempc[3 * k - 3] - 1) + m->nodempc[3 * k - 2];
            values[entries] = m->coefmpc[k - 1];
        }
    }
    starts[m->nmpc] = entries;
    for (int b = 0; b < nboun; b++)
        given[b] = 8 * (nodeboun[b] - 1) + ndirboun[b];
    qless_analysis *analysis = NULL;
    qless_elimination *elimination = NULL;
    need(qless_analyse(m->nmpc, 8 * nk, 0, starts, columns, values, NULL, nboun, given, xboun, NULL, &analysis));
    need(qless_eliminate(analysis, &elimination));
    need(qless_analysis_free(analysis));
    free(starts), free(columns), free(given), free(values);
    return elimination;
}

/* Adds a term to the last equation; `next` says that another one follows. */
static void add_term(mpcs *m, int *term, int dof, double coefficient, int next)
{
    if (*term == m->memmpc) {
        fprintf(stderr, "memmpc = %d is too small\n", m->memmpc);
        exit(1);
    }
    m->nodempc[3 * *term] = dof / 8 + 1, m->nodempc[3 * *term + 1] = dof % 8;
    m->coefmpc[*term] = coefficient;
    *term += 1;
    m->nodempc[3 * *term - 1] = next ? *term + 1 : 0;
}

/* Writes u_s - T u_q - G u_p = 0 for every slave; g is zero because the equations of CalculiX have no right-hand sides. */
static void write_back(const qless_elimination *elimination, mpcs *m)
{
    int64_t ns, nq, np, nt, ng;
    need(qless_sizes(elimination, &ns, &nq, &np, &nt, &ng));
    int32_t *dofs = malloc((ns + nq + np + 1) * sizeof *dofs), *q = dofs + ns, *p = q + nq;
    int32_t *starts_t = malloc(2 * (ns + 1) * sizeof *starts_t), *starts_g = starts_t + ns + 1;
    int32_t *of_t = malloc((nt + ng + 1) * sizeof *of_t), *of_g = of_t + nt;
    double *t = malloc((nt + ng + 1) * sizeof *t), *g = t + nt;
    need(qless_dofs(elimination, dofs, q, p));
    need(qless_t(elimination, starts_t, of_t, t));
    need(qless_g_matrix(elimination, starts_g, of_g, g));
    int term = 0;
    for (int i = 0; i < ns; i++) {
        m->ipompc[i] = term + 1, m->ikmpc[i] = dofs[i], m->ilmpc[i] = i + 1;
        int more = starts_t[i + 1] - starts_t[i] + starts_g[i + 1] - starts_g[i];
        add_term(m, &term, dofs[i], 1, more > 0);
        for (int k = starts_t[i]; k < starts_t[i + 1]; k++)
            add_term(m, &term, q[of_t[k]], -t[k], --more > 0);
        for (int k = starts_g[i]; k < starts_g[i + 1]; k++)
            add_term(m, &term, p[of_g[k]], -g[k], --more > 0);
    }
    m->nmpc = (int)ns;
    free(dofs), free(starts_t), free(of_t), free(t);
}

static void print_cards(const mpcs *m)
{
    for (int i = 0; i < m->nmpc; i++) {
        int terms = 0;
        for (int k = m->ipompc[i]; k != 0; k = m->nodempc[3 * k - 1])
            terms++;
        printf("*EQUATION\n%d\n", terms);
        for (int k = m->ipompc[i]; k != 0; k = m->nodempc[3 * k - 1])
            printf("%d,%d,%.17g\n", m->nodempc[3 * k - 3], m->nodempc[3 * k - 2], m->coefmpc[k - 1]);
    }
}

int main(void)
{
    /* u5 = u6, u5 = u7, u6 = u7, 2 u7 = 2 u8 in direction 1: 5:1 is the slave of two equations, and the third equation says nothing new.
     * 7:1 is prescribed although it is a slave. */
    int ipompc[] = {1, 3, 5, 7}, ikmpc[4], ilmpc[4];
    int nodempc[24] = {5, 1, 2, 6, 1, 0, 5, 1, 4, 7, 1, 0, 6, 1, 6, 7, 1, 0, 7, 1, 8, 8, 1, 0};
    double coefmpc[8] = {1, -1, 1, -1, 1, -1, 2, -2};
    const int nodeboun[] = {7}, ndirboun[] = {1};
    const double xboun[] = {0.01};
    mpcs m = {4, 8, ipompc, nodempc, ikmpc, ilmpc, coefmpc};
    print_cards(&m);
    puts("**");
    qless_elimination *elimination = eliminated(8, &m, 1, nodeboun, ndirboun, xboun);
    write_back(elimination, &m);
    need(qless_elimination_free(elimination));
    print_cards(&m);
    return 0;
}
