// Control pixels: pixels of the image that are rendered a second time with other random numbers, to tell its error.
#include <algorithm>
#include <map>

#include "claray/shared/rng.h"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

/// They make other seeds of that of the image.
constexpr std::uint32_t control_word = 0x5c3a1d27u, second_word = 0x1b56c4e9u;

/// The samples that a control pixel has and those that it is to have.
struct SampleRange {
    std::uint32_t first, end;
    auto operator<=>(const SampleRange&) const = default;
};

/// Other random numbers than the image's, until the end of the scope.
class ScopedSeed {
public:
    ScopedSeed(FrameData& frame, std::uint32_t word) : frame_(frame), before_(frame.seed) {
        frame.seed = hash_words(before_, word);
    }
    ~ScopedSeed() { frame_.seed = before_; }
    ScopedSeed(const ScopedSeed&) = delete;
    ScopedSeed& operator=(const ScopedSeed&) = delete;

private:
    FrameData& frame_;
    std::uint32_t before_;
};

}  // namespace

/// The control pixels are picked when the samples see light first.
Renderer::State::ErrorLook Renderer::State::look_at_controls() {
    ErrorLook look{film.noise_map(), {}, film.radiance(sizes(0, 0))};
    look.expected = expected_variances(look.variances, config.image_width());
    std::vector<ControlPixel>& controls = error.progress.controls;
    const auto is_lit = [](const glm::vec3& c) { return c.x + c.y + c.z > 0; };
    if (controls.empty() && std::ranges::any_of(look.image, is_lit))
        controls = pick_control_pixels(look.expected, config.seed);
    sample_controls(controls, sampling.schedule, control_word);
    return look;
}

std::vector<float> Renderer::error_map() {
    const State::ErrorLook look = state_->look_at_controls();
    return error_intervals(look.image, look.variances, look.expected, state_->error.progress.controls);
}

double Renderer::error_of(std::span<const glm::vec3> image) {
    if (image.size() != state_->pixels())
        throw Error(
            ErrorKind::usage,
            "the image has " + std::to_string(image.size()) + " pixels instead of " + std::to_string(state_->pixels()),
            "give an image of this render");
    const State::ErrorLook look = state_->look_at_controls();
    return error_of_other(image, look.image, look.expected, state_->error.progress.controls);
}

double approximation_error(Renderer& approximate, Renderer& exact) {
    Renderer::State &a = state_of(approximate), &e = state_of(exact);
    if (a.config.width != e.config.width || a.config.height != e.config.height || a.config.region != e.config.region)
        throw Error(ErrorKind::usage, "both renders need the same size", "make a renderer of that size");
    const Renderer::State::ErrorLook look = a.look_at_controls();
    std::vector<ControlPixel> first = a.error.progress.controls;
    for (ControlPixel& control : first) control.sums = {};
    std::vector<ControlPixel> second = first;
    e.sample_controls(first, a.sampling.schedule, control_word);
    e.sample_controls(second, a.sampling.schedule, second_word);
    return error_by_both(look.image, first, second);
}

/// Control pixels that lack the same samples are traced together. Each has an entry that names its pixel in the image,
/// and one that names its place among the control pixels, for their film.
void Renderer::State::sample_controls(std::vector<ControlPixel>& controls, const AdaptiveSchedule& like,
                                      std::uint32_t word) {
    std::map<SampleRange, std::vector<std::uint32_t>> missing;
    for (std::uint32_t k = 0; k < controls.size(); ++k) {
        const std::uint32_t done = controls[k].sums.count + controls[k].sums.dropped;
        const std::uint32_t wanted = like.samples_of(controls[k].pixel);
        if (done < wanted) missing[{done, wanted}].push_back(k);
    }
    if (missing.empty()) return;
    std::vector<std::uint32_t> in_image, in_film;
    for (const auto& [range, numbers] : missing)
        for (const std::uint32_t k : numbers)
            in_image.insert(in_image.end(), {pixel_in_image(controls[k].pixel), 0}),
                in_film.insert(in_film.end(), {k, 0});
    const std::uint32_t first_word = words_of_rounds(), film_word = first_word + std::uint32_t(in_image.size());
    buffers.tables.write(std::span<const std::uint32_t>(in_image), buffers.where.listed_pixels + first_word);
    buffers.tables.write(std::span<const std::uint32_t>(in_film), buffers.where.listed_pixels + film_word);

    std::vector<FilmPixel> sums;
    for (const ControlPixel& control : controls) sums.push_back(control.sums);
    Film film(device, std::uint32_t(controls.size()), config.sample_clamp);
    film.set_sums(sums);
    const ScopedSeed others(wavefront.frame, word);
    std::uint32_t entry = 0;
    for (const auto& [range, numbers] : missing) {
        trace_controls({entry, std::uint32_t(numbers.size()), range.first, range.end - range.first, 1}, film,
                       first_word / 2, buffers.where.listed_pixels + film_word);
        entry += std::uint32_t(numbers.size());
    }
    film.read_sums(sums);
    for (std::size_t k = 0; k < controls.size(); ++k) controls[k].sums = sums[k];
}

/// In batches that take the device as long as others. `first_entry`: where the list of the image begins; `listed`:
/// where that of the film begins, as of Film::accumulate.
void Renderer::State::trace_controls(const Batch& all, Film& film, std::uint32_t first_entry, std::uint32_t listed) {
    InFlight in_flight(device, sampling.pace);
    const std::uint32_t paths = sampling.pace.paths();
    for (std::uint32_t i = 0; i < all.pixels;) {
        const std::uint32_t pixels = std::min(all.pixels - i, paths);
        for (std::uint32_t done = 0; done < all.samples;) {
            const std::uint32_t samples = std::min(all.samples - done, std::max(1u, paths / pixels));
            const Batch some{all.first_pixel + i, pixels, all.first_sample + done, samples, 1};
            Batch of_image = some;
            of_image.first_pixel += first_entry;
            trace_beside(of_image, [&](const Batch& part) {
                if (outputs.matte) outputs.matte->hide(part, wavefront);
                Batch of_film = part;
                of_film.first_pixel -= first_entry;
                film.accumulate(of_film, wavefront.queues.radiance, buffers.tables, listed);
            });
            in_flight.submitted(pixels * samples);
            done += samples;
        }
        i += pixels;
    }
}

/// Guided as the image's samples of the same numbers are, without teaching the guide.
void Renderer::State::trace_beside(const Batch& batch, const std::function<void(const Batch&)>& add) {
    if (sampling.guide && may_guide()) return sampling.guide->trace_beside(batch, wavefront, add);
    wavefront.trace(batch);
    add(batch);
}

}  // namespace claray
