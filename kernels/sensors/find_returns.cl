// What a sensor measures: the surfaces that the rays of a beam met become returns.
#include "sensors/meet.clh"
#include "sensors/noise.clh"
#include "sensors/poses.clh"

#ifndef RETURNS_PER_BEAM
#define RETURNS_PER_BEAM 1
#endif

/// What one ray, or the rays of one return, send back.
typedef struct Echo {
    float range, intensity, share, velocity;
    Met met;         // by the ray of the return with the largest intensity
    float strength;  // of this ray
} Echo;

/// The lidar equation for a surface that is larger than the beam and scatters evenly (Wagner et al. 2006, "Gaussian decomposition and
/// calibration of a novel small-footprint full-waveform digitising airborne laser scanner", section 2.2; Höfle and Pfeifer
/// 2007, "Correction of laser scanning intensity data", section 2), relative to a white surface at the reference range, which the beam meets at a
/// right angle. The air takes its part on both ways.
static inline float intensity_of(const SensorSettings* settings, float reflectance, float cosine, float range) {
    float falloff = 1.0f;
    if (settings->reference_range > 0.0f) {
        const float nearness = settings->reference_range / range;
        falloff = nearness * nearness;
    }
    if (settings->extinction > 0.0f) falloff *= exponential(-2.0f * settings->extinction * range);
    return reflectance * cosine * falloff;
}

static inline Echo echo_of(const SensorSettings* settings, global const float* reflectances, Ray ray, float3 step, float share, Met met) {
    const float3 along = (float3)(ray.dx, ray.dy, ray.dz);
    const float cosine = -dot_product(met.normal, along);
    Echo echo;
    echo.range = met.range, echo.share = share;
    echo.strength = echo.intensity = share * intensity_of(settings, reflectances[met.material], cosine, met.range);
    echo.velocity = (met.departure - dot_product(step, along)) * settings->per_second;
    echo.met = met;
    return echo;
}

/// Adds `other` to a return.
static inline void join(Echo* echo, const Echo* other) {
    const float share = echo->share + other->share;
    echo->range += (other->range - echo->range) * (other->share / share);
    echo->share = share;
    echo->intensity += other->intensity;
    if (other->strength > echo->strength) echo->strength = other->strength, echo->velocity = other->velocity, echo->met = other->met;
}

/// Joins echoes, which are sorted by range, to returns: each begins at the nearest echo that is in none, and has those within the
/// resolution of that one. Returns their number.
static inline uint join_echoes(const SensorSettings* settings, Echo* echoes, uint count) {
    uint returns = 0;
    float begins[RAYS_PER_BEAM], velocities[RAYS_PER_BEAM];
    for (uint i = 0; i < count; ++i) {
        const Echo echo = echoes[i];
        uint k = 0;
        while (k < returns && !(echo.range - begins[k] <= settings->range_resolution &&
                                fabs(echo.velocity - velocities[k]) <= settings->velocity_resolution))
            ++k;
        if (k < returns) {
            join(&echoes[k], &echo);
            continue;
        }
        begins[returns] = echo.range, velocities[returns] = echo.velocity;
        echoes[returns++] = echo;
    }
    return returns;
}

/// The noise of return `number`; false if it is lost.
static inline bool disturb(const SensorSettings* settings, uint seed, uint number, Echo* echo) {
    if (settings->dropout > 0.0f && unit_float(words_of(seed, number, NOISE_OF_DROPOUT).x) < settings->dropout) return false;
    if (settings->range_noise > 0.0f || settings->intensity_noise > 0.0f) {
        const float2 noise = normal_pair(words_of(seed, number, NOISE_OF_RANGE));
        echo->range += settings->range_noise * noise.x;
        echo->intensity *= fmax(1.0f + settings->intensity_noise * noise.y, 0.0f);
    }
    if (settings->velocity_noise > 0.0f)
        echo->velocity += settings->velocity_noise * normal_pair(words_of(seed, number, NOISE_OF_VELOCITY)).x;
    return echo->range >= settings->nearest && echo->range <= settings->farthest && echo->intensity >= settings->least_intensity;
}

/// Whether `a` comes before `b`, which was behind it in range.
static inline bool comes_first(uint order, const Echo* a, const Echo* b) {
    return order == CLARAY_STRONGEST_FIRST ? a->intensity >= b->intensity
         : order == CLARAY_NEAREST_FIRST   ? a->range <= b->range
                                           : a->range > b->range;
}

/// Inserts an echo behind those that come first.
static inline void insert(uint order, Echo* echoes, uint count, Echo echo) {
    uint at = count;
    for (; at > 0 && !comes_first(order, &echoes[at - 1], &echo); --at) echoes[at] = echoes[at - 1];
    echoes[at] = echo;
}

static inline SensorReturn no_return(void) {
    const SensorReturn none = {NAN, NAN, NAN, 0.0f, NAN, NAN, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, CLARAY_MISS, CLARAY_MISS, CLARAY_MISS, 0u, 0u};
    return none;
}

static inline SensorReturn return_of(const SensorSettings* settings, const Frame3* frame, float3 direction, const Echo* echo) {
    const float3 from_sensor = echo->range * direction;
    const float3 place = settings->in_world ? frame->origin + turned(frame, from_sensor) : from_sensor;
    const float3 normal = settings->in_world ? echo->met.normal : turned_back(frame, echo->met.normal);
    const SensorReturn found = {place.x, place.y, place.z, echo->intensity, echo->range, echo->velocity, 0.0f, echo->share,
                                normal.x, normal.y, normal.z, echo->met.material, echo->met.instance, echo->met.primitive, 0u, 0u};
    return found;
}

/// RETURNS_PER_BEAM returns a beam, one beam after the other. `hits`: of the rays with fixed triangles.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void find_returns(MOVERS_PARAMETERS SensorSettings settings, global const SensorPose* poses, global const SensorBeam* beams,
                  global const BeamRay* beam_rays, global const Ray* rays, global const Hit* hits, global const SensorTriangle* triangles,
                  global const SensorPlace* places, global const float* reflectances, global SensorReturn* returns) {
    World world;
    world.triangles = triangles, world.places = places, world.fixed_places = settings.fixed_places;
#if MOVERS && BEAMS_PER_ITEM > 1
    const uint all = settings.sensors * settings.beams, first = (uint)get_global_id(0) * BEAMS_PER_ITEM;
    const uint from = min(first, all) * RAYS_PER_BEAM, to = min(first + BEAMS_PER_ITEM, all) * RAYS_PER_BEAM;
    const Sheaf sheaf = sheaf_of(rays + from, FIXED ? hits + from : 0, to - from);
    PossibleMovers possible;
    find_possible_movers(CLARAY_INSTANCES, &sheaf, &possible);
    world.possible = &possible;
#endif
    FOR_EACH_BEAM(i, settings) {
        const uint sensor = i / settings.beams, number = i - sensor * settings.beams, seed = seed_of_scan(&settings, sensor);
        const SensorBeam beam = beams[number];
        const float3 step = vload3(0, poses[sensor].end) - vload3(0, poses[sensor].begin);
        Echo echoes[RAYS_PER_BEAM];
        uint count = 0;
        for (uint k = 0; k < RAYS_PER_BEAM; ++k) {
            const uint r = i * RAYS_PER_BEAM + k;
            const Ray ray = rays[r];
            const Met met = meet(MOVERS_ARGUMENTS &world, ray, beam.time, &hits[r]);
            if (met.instance == CLARAY_MISS) continue;
            insert(CLARAY_NEAREST_FIRST, echoes, count, echo_of(&settings, reflectances, ray, step, beam_rays[k].share, met));
            ++count;
        }
        if (RAYS_PER_BEAM > 1) count = join_echoes(&settings, echoes, count);
        Echo kept[RAYS_PER_BEAM];
        uint found = 0;
        for (uint k = 0; k < count; ++k)
            if (disturb(&settings, seed, number * RAYS_PER_BEAM + k, &echoes[k])) insert(settings.order, kept, found, echoes[k]), ++found;
        const Frame3 frame = frame_at(&poses[sensor], beam.time);
        for (uint k = 0; k < RETURNS_PER_BEAM; ++k) {
            SensorReturn result = k < found ? return_of(&settings, &frame, (float3)(beam.x, beam.y, beam.z), &kept[k]) : no_return();
            result.time = beam.time * settings.duration;
            result.ring = number / settings.columns, result.column = number - result.ring * settings.columns;
            returns[i * RETURNS_PER_BEAM + k] = result;
        }
    }
}
