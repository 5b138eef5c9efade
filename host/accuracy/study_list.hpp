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

/// A study of trees takes another scene where the given one has too few triangles to tell trees apart.
template <RunStudy run>
Study of_many_triangles(const Device& device, const Scene& scene, const StudyOptions& options,
                        const AccuracyProgress& progress) {
    constexpr std::size_t least = 2000;
    const char* const instead = "terrain:50000";
    const std::size_t count = triangle_count(scene);
    if (count >= least) return run(device, scene, options, progress);
    Study study = run(device, *builtin_scene(instead), options, progress);
    study.title += std::string(", ") + instead;
    study.findings.insert(study.findings.begin(), "these are trees of " + std::string(instead) + ": the scene has " +
                                                      std::to_string(count) +
                                                      " triangles, too few for trees to differ");
    return study;
}

inline constexpr NamedStudy all_studies[] = {{"hard-rays", study_hard_rays, nullptr, false},
                                             {"scene-rays", study_scene_rays, nullptr, false},
                                             {"builds", of_many_triangles<study_builds>, nullptr, false},
                                             {"trees", of_many_triangles<study_trees>, nullptr, false},
                                             {"nodes", of_many_triangles<study_nodes>, nullptr, false},
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
