/* An FMU of somebody else, with one output that is the time; what goes wrong, and where, is compiled in. */
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

#ifndef FAULT
#define FAULT
#endif
/* One of these is defined as the place of the fault. */
#ifdef IN_STEP
#define STEP_FAULT FAULT
#else
#define STEP_FAULT
#endif
#ifdef IN_FREE
#define FREE_FAULT FAULT
#else
#define FREE_FAULT
#endif

static double now;

const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const void *callbacks,
                      int visible, int logging)
{
    return &now;
}
void fmi2FreeInstance(void *instance) { FREE_FAULT; }
int fmi2SetupExperiment(void *instance, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
    now = start;
    return 0;
}
int fmi2EnterInitializationMode(void *instance) { return 0; }
int fmi2ExitInitializationMode(void *instance) { return 0; }
int fmi2Terminate(void *instance) { return 0; }
int fmi2DoStep(void *instance, double time, double step, int no_return)
{
    if (time > 0.045) {
        STEP_FAULT;
    }
    now = time + step;
    return 0;
}
int fmi2GetReal(void *instance, const unsigned *references, size_t count, double *values)
{
    for (size_t k = 0; k < count; k++) {
        values[k] = now;
    }
    return 0;
}
int fmi2SetReal(void *instance, const unsigned *references, size_t count, const double *values) { return 0; }
int fmi2GetInteger(void *instance, const unsigned *references, size_t count, int *values) { return 0; }
int fmi2SetInteger(void *instance, const unsigned *references, size_t count, const int *values) { return 0; }
int fmi2GetBoolean(void *instance, const unsigned *references, size_t count, int *values) { return 0; }
int fmi2SetBoolean(void *instance, const unsigned *references, size_t count, const int *values) { return 0; }
int fmi2GetString(void *instance, const unsigned *references, size_t count, const char **values) { return 0; }
int fmi2SetString(void *instance, const unsigned *references, size_t count, const char **values) { return 0; }
