#include <pthread.h>
static void alone(Probe* p) { build(p, ""), prepare(p), launch(p, 16384, 64); }
static void* run(void* probe) {
    Probe* p = (Probe*)probe;
    return try_probe(p, p->device, p->source, alone), probe;
}
static void probe(Probe* p) {
    pthread_t threads[2];
    for (int round = 0; round < 4; ++round) {
        Probe* both = (Probe*)calloc(2, sizeof *p);
        for (int i = 0; i < 2; ++i) both[i].device = p->device, both[i].source = p->source;
        for (int i = 0; i < 2; ++i) pthread_create(&threads[i], NULL, run, &both[i]);
        for (int i = 0; i < 2; ++i) pthread_join(threads[i], NULL);
        for (int i = 0; i < 2; ++i) expect(p, both[i].wrong == 0 && both[i].tried > 0, both[i].what, i);
        free(both);
    }
}
