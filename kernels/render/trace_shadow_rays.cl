// The stage of shadow rays that add their light themselves: the query any_hit, which adds the light of a ray that hits nothing to
// its path instead of writing an answer.
#include "render/queue.clh"

#define ANSWERS_PARAMETERS global const LightSample *light, global float *radiance
#define ANSWERS {light, radiance}
#define NO_ANSWERS {0, 0}
typedef struct Answers {
    global const LightSample* light;
    global float* radiance;
} Answers;

static inline void answer(const Answers* to, uint i, bool occluded) {
    if (!occluded) add_light_sample(queued_light(&to->light[i]), to->radiance);
}

#include "trace/any_hit.cl"
