// What chooses near lights, to compare it with sums in float64: picks from lists, and densities of directions to hot spots.
#include "lights/light_hot_spot.clh"
#if CLARAY_CPU
#include "lights/light_lists_sixteen.clh"
#include "lights/lanes/hot_spot_lanes.clh"
#endif

/// Sixteen places per item, each with a position and a normal: the light picked for each by one surface and, on CPUs, by sixteen, and the
/// probability of the light that each asks for.
kernel void pick_listed_lights(global const uint* table, global const PunctualLight* lights, global const float* places,
                               global const float* random, global const uint* asked, uint count, global ListPick* alone,
                               global ListPick* together, global float* probabilities) {
    const uint first = 16 * get_global_id(0);
    if (first >= count) return;
#if CLARAY_CPU
    Lanes16 lanes = {{{0.0f}}};
#endif
    for (uint k = 0; k < 16; ++k) {
        const uint i = first + k;
        const float3 from = vload3(2 * i, places), normal = vload3(2 * i + 1, places);
        alone[i] = together[i] = pick_from_lists(table, lights, from, normal, random[i]);
        probabilities[i] = probability_in_lists(table, lights, asked[i], from, normal);
#if CLARAY_CPU
        keep_vector16(from, &lanes, ROW_LIST_FROM, k), keep_vector16(normal, &lanes, ROW_LIST_NORMAL, k);
        lanes.value[ROW_LIST_RANDOM][k] = random[i];
#endif
    }
#if CLARAY_CPU
    ListPick picks[16];
    pick_from_lists16(table, lights, &lanes, 0xffffu, picks);
    for (uint k = 0; k < 16; ++k) together[first + k] = picks[k];
#endif
}

#define NUMBERS_OF_SPOT 12u  // light, way, from and direction, as in density_of_spot

/// Sixteen hot spots per item, by one ray and, on CPUs, by sixteen.
kernel void see_hot_spots(global const float* numbers, uint count, global float* alone, global float* together) {
    const uint first = 16 * get_global_id(0);
    if (first >= count) return;
#if CLARAY_CPU
    Lanes16 lanes = {{{0.0f}}};
#endif
    for (uint k = 0; k < 16; ++k) {
        global const float* at = numbers + NUMBERS_OF_SPOT * (first + k);
        alone[first + k] = together[first + k] = density_of_spot(vload3(0, at), vload3(1, at), vload3(2, at), vload3(3, at));
#if CLARAY_CPU
        for (uint j = 0; j < NUMBERS_OF_SPOT; ++j) lanes.value[j][k] = at[j];
#endif
    }
#if CLARAY_CPU
    vstore16(density_of_spot16(lane_vectors16(&lanes, 0), lane_vectors16(&lanes, 3), lane_vectors16(&lanes, 6), lane_vectors16(&lanes, 9)),
             0, together + first);
#endif
}
