// Which surfaces the camera rays of each pixel meet, by name: write_numbers of render/write_aovs.cl.
#include "claray/cryptomatte.hpp"

#include <algorithm>
#include <map>

#include "host/compute/read_back.hpp"
#include "host/compute/state_of.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

/// What a ray met, by the numbers of the traced scene; CLARAY_MISS of what is not there.
struct Met {
    std::uint32_t primitive, material, instance;
};
static_assert(sizeof(Met) == 3 * sizeof(std::uint32_t));

/// Calls visit(pixel, met) for a sample of each pixel.
template <class Visit>
void for_each_met(Renderer::State& state, SceneQuery& trace, Kernel& write, std::uint32_t sample, const Visit& visit) {
    Wavefront& wavefront = state.wavefront;
    const std::uint32_t all = state.pixels(), most = std::min(wavefront.queues.capacity, all);
    const Buffer<std::uint32_t> numbers(state.device, 3 * std::size_t(most));
    std::vector<Met> met(most);
    for (std::uint32_t first = 0; first < all; first += most) {
        const std::uint32_t count = std::min(most, all - first);
        wavefront.trace_first_hits(state.in_image({first, count, sample, 1, 0}), trace, false);
        write.run({count, 64}, wavefront.step_of({}, 0, count), wavefront.scene, wavefront.queues.hits,
                  arg("numbers", numbers));
        read_back(numbers, std::span(met).first(count));
        for (std::uint32_t i = 0; i < count; ++i) visit(first + i, met[i]);
    }
}

/// The names of what rays meet, each with a number of its own.
class MatteNames {
public:
    MatteNames(const SceneShape& shape, MatteKind kind) : shape_(shape), kind_(kind) {
        const SurfaceNames& names = shape.surfaces.names();
        by_number_ = numbered(kind == MatteKind::material ? names.materials : names.objects);
        if (kind == MatteKind::object) by_instance_ = numbered(names.instances);
    }

    /// CLARAY_MISS: nothing is there.
    [[nodiscard]] std::uint32_t number_of(const Met& met) const {
        if (met.primitive == CLARAY_MISS) return CLARAY_MISS;
        if (kind_ == MatteKind::material) return by_number_.at(met.material);
        if (kind_ == MatteKind::object)
            if (const std::uint32_t instance = shape_.surfaces.instance_of(met.primitive, met.instance);
                instance != CLARAY_MISS)
                return by_instance_.at(instance);
        return by_number_.at(shape_.surfaces.object_of(shape_.numbers.number_there(met.primitive)));
    }
    [[nodiscard]] const std::vector<std::pair<std::string, std::uint32_t>>& all() const { return all_; }

private:
    std::vector<std::uint32_t> numbered(const std::vector<std::string>& names) {
        std::vector<std::uint32_t> numbers;
        for (const std::string& name : names) {
            const auto [at, is_new] = number_of_name_.try_emplace(name, std::uint32_t(all_.size()));
            if (is_new) all_.emplace_back(name, matte_hash(name));
            numbers.push_back(at->second);
        }
        return numbers;
    }

    const SceneShape& shape_;
    MatteKind kind_;
    std::map<std::string, std::uint32_t> number_of_name_;
    std::vector<std::pair<std::string, std::uint32_t>> all_;
    std::vector<std::uint32_t> by_number_, by_instance_;
};

/// How many samples of a pixel met a name.
struct Count {
    std::uint32_t name, samples;
};

void add(std::vector<Count>& counts, std::uint32_t name) {
    const auto at = std::find_if(counts.begin(), counts.end(), [&](const Count& c) { return c.name == name; });
    if (at == counts.end())
        counts.push_back({name, 1});
    else
        ++at->samples;
}

const char* name_of(MatteKind kind) {
    return std::find_if(std::begin(matte_rows), std::end(matte_rows), [&](auto& row) { return row.kind == kind; })
        ->name;
}

}  // namespace

Cryptomatte cryptomatte(const Renderer& renderer, MatteKind kind, unsigned samples) {
    if (samples == 0) throw Error(ErrorKind::usage, "samples is 0", "use 64, for example");
    Renderer::State& state = state_of(renderer);
    const MatteNames names(state.source.shape, kind);
    QueryOptions options;
    options.cull_back_faces = state.buffers.textures.culls_back_faces;
    SceneQuery trace(state.buffers.structure, QueryKernel::Kind::closest, options, {});
    Kernel write = load_kernel(state.device, "render/write_aovs.cl", "write_numbers",
                               defines_of_aovs(state.buffers, state.wavefront.kernels.config.effects));
    std::vector<std::vector<Count>> pixels(state.pixels());
    for (unsigned sample = 0; sample < samples; ++sample)
        for_each_met(state, trace, write, sample, [&](std::uint32_t pixel, const Met& met) {
            if (const std::uint32_t name = names.number_of(met); name != CLARAY_MISS) add(pixels[pixel], name);
        });
    Cryptomatte matte{.name = name_of(kind), .ranks = 2, .parts = {}, .manifest = names.all()};
    for (std::vector<Count>& counts : pixels) {
        std::stable_sort(counts.begin(), counts.end(), [](auto& a, auto& b) { return a.samples > b.samples; });
        matte.ranks = std::max(matte.ranks, std::min(most_matte_ranks, (unsigned(counts.size()) + 1) / 2 * 2));
    }
    matte.parts.reserve(matte.ranks * pixels.size());
    for (const std::vector<Count>& counts : pixels)
        for (unsigned rank = 0; rank < matte.ranks; ++rank) {
            const bool is_there = rank < counts.size();
            matte.parts.push_back(is_there ? MattePart{matte_id(matte.manifest[counts[rank].name].second),
                                                       float(counts[rank].samples) / float(samples)}
                                           : MattePart{});
        }
    return matte;
}

}  // namespace claray
