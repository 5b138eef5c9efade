// How many samples per pixel fit into a frame.
#pragma once

#include <algorithm>

namespace claray {

/// The time that `measure` tells, measured again if it is above `budget`: other work may have delayed a frame.
template <class Measure>
double undelayed(double budget, const Measure& measure) {
    const double seconds = measure();
    return seconds <= budget ? seconds : std::min(seconds, measure());
}

struct PickedSamples {
    unsigned spp = 1;
    double seconds = 0;  // of a frame of these
};

/// Samples are cheaper together, since a frame takes time of its own: tries two, then as many as fit by what each
/// further one took, and searches between those that fit and those that do not, to within a 32nd. The next that could
/// fit are measured in any case, since one slow frame makes them look too long. `one`: seconds of a frame of one
/// sample, which fits. `time_of`: of a frame of so many, measured.
template <class Time>
PickedSamples pick_samples(double one, unsigned most, double budget, const Time& time_of) {
    PickedSamples fits{1, one};
    unsigned too_many = most + 1;
    while (too_many - fits.spp > 1 + fits.spp / 32) {
        const double each = fits.spp > 1 ? (fits.seconds - one) / (fits.spp - 1) : one;
        const double more = each > 0 ? (budget - fits.seconds) / each : double(most);
        const unsigned last = too_many <= most ? (fits.spp + too_many) / 2 : most;
        const unsigned least = fits.spp + 1 + fits.spp / 32;
        const unsigned next = std::max(unsigned(std::min(fits.spp + more, double(last))), least);
        const double seconds = time_of(next);
        if (seconds <= budget)
            fits = {next, seconds};
        else
            too_many = next;
    }
    return fits;
}

}  // namespace claray
