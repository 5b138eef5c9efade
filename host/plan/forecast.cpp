#include "host/plan/forecast.hpp"

#include <algorithm>
#include <cmath>

namespace claray {
namespace {

constexpr unsigned least_spp_to_foresee = 16;

}  // namespace

/// The power of the samples with which the squared error falls: 1 for independent samples, up to 1.5 for Sobol's if
/// integrands are discontinuous along edges only (He and Wang 2015). 1 while there are too few samples to estimate it.
double Watched::convergence(const RenderProgress& so_far) const {
    constexpr double least_growth = 4, fastest = 1.5;
    const double samples = double(so_far.error_spp) / error_->error_spp, errors = so_far.error / error_->error;
    if (!(samples >= least_growth)) return 1;
    return std::clamp(-2 * std::log(errors) / std::log(samples), 1.0, fastest);
}

Forecast Watched::forecast(const RenderProgress& so_far, double error) const {
    const double times = std::pow(so_far.error_bound / error, 2 / convergence(so_far));
    Forecast needed;
    needed.spp = std::max<double>(so_far.error_spp * times, so_far.spp);
    needed.seconds_a_sample = so_far.spp > pace_->spp ? (so_far.seconds - pace_->seconds) / (so_far.spp - pace_->spp)
                                                      : so_far.seconds / so_far.spp;
    needed.seconds = so_far.seconds + (needed.spp - so_far.spp) * needed.seconds_a_sample;
    return needed;
}

std::optional<Forecast> Watched::foresee(const RenderProgress& so_far, double error, double least_seconds) {
    const bool known = so_far.error_bound > 0 && so_far.error_spp >= least_spp_to_foresee;
    if (known && !error_) error_ = so_far;
    if (so_far.own_kernels && !pace_) pace_ = so_far;
    if (!known || !pace_ || so_far.seconds - pace_->seconds < least_seconds) return {};
    return forecast(so_far, error);
}

}  // namespace claray
