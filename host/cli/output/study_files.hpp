// The files of claray accuracy: each study is in them as soon as it is measured.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "claray/accuracy.hpp"
#include "host/cli/output/outputs.hpp"

namespace claray::cli {

/// Paths that are empty are not written, nor plots without points.
struct StudyPaths {
    std::filesystem::path csv, html, svg;
    std::filesystem::path svgs, maps;  ///< folders
};

/// A study of several, and its error maps.
struct StudyResult {
    std::optional<Study> study;  ///< without findings while it is measured
    std::vector<ErrorMap> maps;
    bool finished = false;
};

/// Writes what is measured whenever there is more, so that a program that is killed leaves it. Files are replaced as a
/// whole; devices and pipes are written at the end only. May be called from several threads.
class StudyFiles {
public:
    StudyFiles(StudyPaths paths, std::string scene, std::string subtitle, const RenderConfig& image,
               std::size_t studies)
        : paths_(std::move(paths)),
          scene_(std::move(scene)),
          subtitle_(std::move(subtitle)),
          width_(image.width),
          height_(image.height),
          results_(studies) {}

    [[nodiscard]] const std::string& subtitle() const { return subtitle_; }
    /// Adds the points that study number `index` has so far to the CSV.
    void update(std::size_t index, Study so_far);
    /// Adds a finished study to all files.
    void finish(std::size_t index, Study study, std::vector<ErrorMap> maps);
    /// Writes everything again and throws the first error.
    void write() const;
    /// In their order.
    [[nodiscard]] std::vector<Study> finished() const;

private:
    [[nodiscard]] std::vector<Study> studies(bool unfinished) const;
    void write_csv(Writes& writes) const;
    void write_plots(Writes& writes) const;
    void write_maps(Writes& writes, const StudyResult& result) const;

    StudyPaths paths_;
    std::string scene_, subtitle_;
    unsigned width_, height_;
    mutable std::mutex mutex_;
    std::vector<StudyResult> results_;
};

}  // namespace claray::cli
