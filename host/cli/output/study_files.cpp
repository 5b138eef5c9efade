#include "host/cli/output/study_files.hpp"

#include "claray/io.hpp"
#include "host/accuracy/plot.hpp"
#include "host/base/file.hpp"

namespace claray::cli {

void StudyFiles::update(std::size_t index, Study so_far) {
    const std::lock_guard lock(mutex_);
    results_[index].study = std::move(so_far);
    Writes ignored;  // the end tries again, and tells
    if (is_replaced(paths_.csv)) write_csv(ignored);
}

void StudyFiles::finish(std::size_t index, Study study, std::vector<ErrorMap> maps) {
    const std::lock_guard lock(mutex_);
    results_[index] = {std::move(study), std::move(maps), true};
    Writes ignored;
    if (is_replaced(paths_.csv)) write_csv(ignored);
    if (is_replaced(paths_.html) && is_replaced(paths_.svg)) write_plots(ignored);
    write_maps(ignored, results_[index]);
}

void StudyFiles::write() const {
    const std::lock_guard lock(mutex_);
    Writes writes;
    for (const StudyResult& result : results_) write_maps(writes, result);
    write_csv(writes);
    write_plots(writes);
    writes.finish();
}

std::vector<Study> StudyFiles::finished() const {
    const std::lock_guard lock(mutex_);
    return studies(false);
}

std::vector<Study> StudyFiles::studies(bool unfinished) const {
    std::vector<Study> all;
    for (const StudyResult& result : results_)
        if (result.study && (unfinished || result.finished)) all.push_back(*result.study);
    return all;
}

void StudyFiles::write_csv(Writes& writes) const {
    if (!paths_.csv.empty()) writes.attempt([&] { write_file(paths_.csv, csv_of(studies(true), scene_)); });
}

void StudyFiles::write_plots(Writes& writes) const {
    const std::vector<Study> all = studies(false);
    const auto write = [&](const std::filesystem::path& path, const std::string& text) {
        writes.attempt([&] { write_file(path, text); });
    };
    if (!paths_.html.empty()) write(paths_.html, html_of(all, "Accuracy against time: " + scene_, subtitle_));
    for (const Study& study : all) {
        if (!has_plot(study)) continue;
        if (!paths_.svg.empty()) write(paths_.svg, svg_of(study, subtitle_));  // the only study
        if (!paths_.svgs.empty()) write(paths_.svgs / (study.name + ".svg"), svg_of(study, subtitle_));
    }
}

/// As values and in false colours.
void StudyFiles::write_maps(Writes& writes, const StudyResult& result) const {
    if (paths_.maps.empty()) return;
    for (const ErrorMap& map : result.maps)
        writes.attempt([&] {
            write_pfm(paths_.maps / (map.name + ".pfm"), width_, height_, map.pixels);
            write_image(paths_.maps / (map.name + ".png"), false_color(width_, height_, map.pixels), 0, ToneMap::none);
        });
}

}  // namespace claray::cli
