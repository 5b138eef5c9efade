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
};
inline constexpr NamedStudy all_studies[] = {{"hard-rays", study_hard_rays},
                                             {"scene-rays", study_scene_rays},
                                             {"builds", study_builds},
                                             {"trees", study_trees},
                                             {"nodes", study_nodes},
                                             {"sampling", study_sampling},
                                             {"techniques", study_techniques},
                                             {"denoising", study_denoising},
                                             {"bias", study_bias},
                                             {"arithmetic", study_arithmetic},
                                             {"sums", study_sums},
                                             {"filtering", study_filtering},
                                             {"depth", nullptr, study_depth},
                                             {"gamma", study_gamma},
                                             {"shading", study_shading},
                                             {"effects", nullptr, study_effects}};

}  // namespace claray
