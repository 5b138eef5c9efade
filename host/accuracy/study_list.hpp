// All studies of accuracy by their names: those of `claray accuracy --only` and of the Python package.
#pragma once

#include <vector>

#include "claray/accuracy.hpp"

namespace claray {

using RunStudy = Study (*)(const Device&, const Scene&, const StudyOptions&, const AccuracyProgress&);
using RunStudyWithMaps = Study (*)(const Device&, const Scene&, const StudyOptions&, const AccuracyProgress&,
                                   std::vector<ErrorMap>*);
struct NamedStudy {
    const char* name;
    RunStudy run;  ///< null for studies that also make maps
    RunStudyWithMaps run_with_maps = nullptr;
    bool samples = true;  ///< renders the scene with samples per pixel
};
inline constexpr NamedStudy all_studies[] = {{"hard-rays", study_hard_rays, nullptr, false},
                                             {"scene-rays", study_scene_rays, nullptr, false},
                                             {"builds", study_builds, nullptr, false},
                                             {"trees", study_trees, nullptr, false},
                                             {"nodes", study_nodes, nullptr, false},
                                             {"sampling", study_sampling},
                                             {"techniques", study_techniques},
                                             {"denoising", study_denoising},
                                             {"bias", study_bias},
                                             {"arithmetic", study_arithmetic},
                                             {"sums", study_sums, nullptr, false},
                                             {"filtering", study_filtering},
                                             {"depth", nullptr, study_depth, false},
                                             {"gamma", study_gamma},
                                             {"shading", study_shading},
                                             {"effects", nullptr, study_effects}};

}  // namespace claray
