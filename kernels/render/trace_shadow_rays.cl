// The stage of shadow rays, where these add their light themselves: the query any_hit, whose answers are not written down. Light that
// nothing was in the way of reaches its path at once.
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
