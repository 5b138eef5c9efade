// Adds the layers of paths to their pixels, as accumulate_film adds their radiance: samples that are left out or scaled down there are
// here, too.
#include "render/accumulate_film.cl"
#include "render/layers/layer_sums.clh"

/// One work-item per entry of the batch. `radiance`: of `room` paths, with their layers. `sums`: for each layer one of each of `pixels`.
kernel void accumulate_layers(Batch batch, global const uint* tables, uint listed, float limit, global float* radiance, uint room, uint pixels,
                              global ColorSum* sums) {
    uint i = get_global_id(0);
    if (i >= batch.pixels || !is_first_entry(batch, tables, listed, i)) return;
    const Layers layers = layers_behind(radiance, room);
    const uint at = film_pixel(batch, tables, listed, i), count = layers_in(&layers);
    do {
        for (uint path = i * batch.samples; path < (i + 1u) * batch.samples; ++path) {
            const float3 sample = vload3(path, radiance);
            if (!can_be_summed(sample)) continue;
            const float brightest = largest(fabs(sample)), scale = limit > 0.0f && brightest > limit ? limit / brightest : 1.0f;
            for (uint layer = 0; layer < count; ++layer) {
                ColorSum sum = sums[layer * (size_t)pixels + at];
                add_color(&sum, scale * vload3(path, light_of_layer(&layers, layer)));
                sums[layer * (size_t)pixels + at] = sum;
            }
        }
    } while (is_next_entry(batch, tables, listed, ++i));
}
