#include "host/accuracy/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "host/accuracy/study.hpp"
#include "host/accuracy/svg.hpp"

namespace claray {
namespace {

constexpr double width = 760, height = 536, left = 84, right = 24, top = 100, bottom = 64;
constexpr const char *ink = "#222", *pale = "#666", *grid = "#e4e4e4";
/// Colours that are distinct for any colour vision (Okabe and Ito 2008), dark ones first; shapes differ, too.
constexpr std::array colors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};

using svg::rectangle;
using svg::text;

std::string line(double x0, double y0, double x1, double y1, const char* color, double thick, const char* more = "") {
    return printed("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\" stroke-width=\"%.1f\"%s/>\n",
                   x0, y0, x1, y1, color, thick, more);
}

/// A logarithmic axis: maps values to pixels; ticks at decades or, on short axes, at parts of them. The value 0 has a
/// place of its own.
struct Axis {
    double low, high, from, to, zero = 0;
    Axis(std::vector<double> values, double pixel_from, double pixel_to) : from(pixel_from), to(pixel_to) {
        std::erase_if(values, [](double v) { return !(v > 0); });
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        low = values.empty() ? 0.1 : *least / 1.3, high = values.empty() ? 1 : *most * 1.3;
    }
    [[nodiscard]] double at(double value) const {
        if (!(value > 0)) return zero;
        return from + (to - from) * (std::log(value) - std::log(low)) / (std::log(high) - std::log(low));
    }
    [[nodiscard]] std::vector<double> ticks() const {
        static const std::vector<double> whole = {1}, some = {1, 2, 5}, many = {1, 1.5, 2, 3, 4, 5, 6, 8};
        const double range = high / low;
        std::vector<double> ticks;
        const int first = int(std::floor(std::log10(low))), last = int(std::ceil(std::log10(high)));
        for (int power = first; power < last; ++power)
            for (const double part : range > 1000 ? whole : range > 10 ? some : many)
                if (const double tick = std::pow(10, power) * part; tick > low && tick < high) ticks.push_back(tick);
        return ticks;
    }
};

/// Errors relative to a mean are printed in per cent.
bool is_share(const Study& study) { return study.error.ends_with("/ mean"); }

/// "0.002", "50", "1e-05", "2 %"
std::string tick_label(double value, bool share = false) {
    return share ? printed("%g", 100 * value) + " %" : printed("%g", value);
}

std::string marker(double x, double y, std::size_t shape, const char* color, bool filled) {
    const std::string paint =
        std::string("fill=\"") + (filled ? color : "#fff") + "\" stroke=\"" + color + "\" stroke-width=\"2\"/>\n";
    const auto points = [&](std::initializer_list<std::pair<double, double>> corners) {
        std::string list = "<polygon points=\"";
        for (const auto& [dx, dy] : corners) list += printed("%.1f", x + dx) + "," + printed("%.1f", y + dy) + " ";
        return list + "\" " + paint;
    };
    switch (shape % 4) {
        case 0: return "<circle cx=\"" + printed("%.1f", x) + "\" cy=\"" + printed("%.1f", y) + "\" r=\"5\" " + paint;
        case 1: return points({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
        case 2: return points({{0, -6}, {6, 5}, {-6, 5}});
        default: return points({{0, -6}, {6, 0}, {0, 6}, {-6, 0}});
    }
}

std::vector<std::string> methods_of(const Study& study) {
    std::vector<std::string> methods;
    for (const StudyPoint& p : study.points)
        if (std::find(methods.begin(), methods.end(), p.method) == methods.end()) methods.push_back(p.method);
    return methods;
}

std::string draw_axes(const Axis& x, const Axis& y, const Study& study) {
    std::string svg;
    if (x.zero > 0) {
        svg += line(x.zero, top, x.zero, height - bottom, grid, 1) +
               line(x.from - 6, top, x.from - 6, height - bottom, pale, 1, " stroke-dasharray=\"3 4\"") +
               text(x.zero, height - bottom + 18, "middle", 12, pale, "0");
    }
    for (const double v : x.ticks()) {
        svg += line(x.at(v), top, x.at(v), height - bottom, grid, 1);
        svg += text(x.at(v), height - bottom + 18, "middle", 12, pale, tick_label(v, is_share(study)));
    }
    for (const double v : y.ticks()) {
        svg += line(left, y.at(v), width - right, y.at(v), grid, 1);
        svg += text(left - 8, y.at(v) + 4, "end", 12, pale, tick_label(v));
    }
    svg += line(left, height - bottom, width - right, height - bottom, ink, 1) +
           line(left, top, left, height - bottom, ink, 1);
    svg += text((left + width - right) / 2, height - 20, "middle", 13, ink, study.error);
    svg += text(22, (top + height - bottom) / 2, "middle", 13, ink, study.cost,
                " transform=\"rotate(-90 22 " + printed("%.0f", (top + height - bottom) / 2) + ")\"");
    return svg;
}

/// Rectangles of text and marks that labels must not cover.
struct Taken {
    double x0, y0, x1, y1;
};

bool is_free(const Taken& place, const std::vector<Taken>& taken) {
    if (place.x0 < left || place.x1 > width - right || place.y0 < top || place.y1 > height - bottom) return false;
    return std::none_of(taken.begin(), taken.end(), [&](const Taken& t) {
        return place.x0 < t.x1 && t.x0 < place.x1 && place.y0 < t.y1 && t.y0 < place.y1;
    });
}

/// The setting's name beside its mark, in the first of four positions that is free; nothing if none is.
std::string draw_label(const std::string& words, double x, double y, std::vector<Taken>& taken) {
    constexpr double size = 11, gap = 9;
    const double length = 0.58 * size * double(words.size());
    const std::pair<double, double> corners[] = {
        {x + gap, y - gap - size}, {x - gap - length, y - gap - size}, {x + gap, y + 4}, {x - gap - length, y + 4}};
    for (const auto& [left_end, upper_end] : corners) {
        const Taken place = {left_end, upper_end, left_end + length, upper_end + size};
        if (!is_free(place, taken)) continue;
        taken.push_back(place);
        return text(place.x0, place.y1 - 2, "start", size, pale, words,
                    " stroke=\"#fff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"");
    }
    return {};
}

bool is_drawn(const StudyPoint& p) { return p.failure.empty() && p.error.median >= 0 && p.seconds.median > 0; }

/// Whether the settings of a method are those of one parameter, in order: between others there is nothing to connect.
bool is_series(const Study& study, const std::string& method) {
    std::vector<double> values;
    for (const StudyPoint& p : study.points)
        if (p.method == method) values.push_back(p.value);
    const auto strictly = [&](auto order) {
        return std::adjacent_find(values.begin(), values.end(), order) == values.end();
    };
    return study.sweeps && (strictly(std::greater_equal<>()) || strictly(std::less_equal<>()));
}

std::string draw_curve(const Study& study, const std::string& method, std::size_t index, const Axis& x, const Axis& y) {
    const char* color = colors[index % colors.size()];
    std::string path, marks;
    bool gap = true;
    for (const StudyPoint& p : study.points) {
        if (p.method != method) continue;
        if (!is_drawn(p)) {
            gap = true;
            continue;
        }
        const double px = x.at(p.error.median), py = y.at(p.seconds.median);
        path += (gap ? " M" : " L") + printed("%.1f", px) + " " + printed("%.1f", py);
        gap = false;
        const double least = p.error.median > 0 ? std::max(p.error.low, x.low) : 0;
        marks += line(x.at(least), py, x.at(p.error.high), py, color, 1);
        marks += line(px, y.at(std::max(p.seconds.low, y.low)), px, y.at(p.seconds.high), color, 1);
        marks += marker(px, py, index, color, p.front);
    }
    if (!is_series(study, method)) return marks;
    return "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + color + "\" stroke-width=\"1.5\"/>\n" + marks;
}

/// Whether the point is its method's first or last one.
bool is_end(const Study& study, std::size_t i) {
    const auto same = [&](std::size_t k) {
        return k < study.points.size() && study.points[k].method == study.points[i].method;
    };
    return i == 0 || !same(i - 1) || !same(i + 1);
}

/// Those of the front first, since room may run out. Of many curves only the ends.
std::string draw_labels(const Study& study, const Axis& x, const Axis& y) {
    std::vector<Taken> taken;
    for (const StudyPoint& p : study.points)
        if (is_drawn(p)) {
            const double px = x.at(p.error.median), py = y.at(p.seconds.median);
            taken.push_back({px - 6, py - 6, px + 6, py + 6});
        }
    std::string svg;
    for (const bool front : {true, false})
        for (std::size_t i = 0; i < study.points.size(); ++i)
            if (const StudyPoint& p = study.points[i];
                is_drawn(p) && p.front == front && (!study.sweeps || study.points.size() <= 16 || is_end(study, i)))
                svg += draw_label(p.setting, x.at(p.error.median), y.at(p.seconds.median), taken);
    return svg;
}

std::string table_of(const Study& study) {
    const std::vector<std::string> facts = fact_names(study);
    std::string html = "<table><tr><th>method</th><th>setting</th><th>error</th><th>quartiles</th>";
    for (const std::string& fact : facts) html += "<th>" + escaped(fact) + "</th>";
    html += "<th>" + escaped(study.cost) + "</th><th>quartiles</th><th>runs</th><th>front</th></tr>\n";
    for (const StudyPoint& p : study.points) {
        html += "<tr><td>" + escaped(p.method) + "</td><td>" + escaped(p.setting) + "</td>";
        if (!p.failure.empty()) {
            html += "<td colspan=\"" + printed("%.0f", 6.0 + double(facts.size())) + "\">" + escaped(p.failure) +
                    "</td></tr>\n";
            continue;
        }
        const auto cell = [&](const std::string& words) { html += "<td class=\"n\">" + words + "</td>"; };
        const double unit = is_share(study) ? 100 : 1;
        cell(printed("%.4g", unit * p.error.median) + (is_share(study) ? " %" : ""));
        cell(printed("%.3g", unit * p.error.low) + " .. " + printed("%.3g", unit * p.error.high));
        for (const std::string& fact : facts) {
            const double value = fact_of(p, fact);
            cell(std::isnan(value) ? "" : printed("%.4g", value));
        }
        cell(printed("%.4g", p.seconds.median));
        cell(printed("%.3g", p.seconds.low) + " .. " + printed("%.3g", p.seconds.high));
        cell(std::to_string(p.runs));
        cell(p.front ? "yes" : "");
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

/// Marks and names of the methods, then `rest`, in one row or two.
std::string draw_legend(const std::vector<std::string>& methods, const std::string& rest) {
    double x = left, y = 64;
    const auto place = [&](std::size_t letters) {
        const double length = 40 + 7.0 * double(letters), at = x;
        if (at + length - 23 <= width - 8 || y > 64) return x += length, at;
        y += 18, x = left + length;
        return left;
    };
    std::string svg;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        const double at = place(methods[i].size());
        svg +=
            marker(at + 6, y, i, colors[i % colors.size()], true) + text(at + 17, y + 4, "start", 12, ink, methods[i]);
    }
    if (rest.empty()) return svg;
    const double at = place(rest.size());
    return svg + text(at + 8, y + 4, "start", 12, pale, rest);
}

}  // namespace

bool has_plot(const Study& study) { return std::any_of(study.points.begin(), study.points.end(), is_drawn); }

std::string svg_of(const Study& study, const std::string& subtitle) {
    std::vector<double> errors, seconds;
    bool some_are_zero = false;
    for (const StudyPoint& p : study.points) {
        if (!is_drawn(p)) continue;
        some_are_zero |= p.error.median == 0;
        errors.insert(errors.end(), {p.error.low, p.error.median, p.error.high});
        seconds.insert(seconds.end(), {p.seconds.low, p.seconds.median, p.seconds.high});
    }
    if (study.floor > 0) errors.push_back(study.floor);
    Axis x(errors, some_are_zero ? left + 44 : left, width - right);
    if (some_are_zero) x.zero = left + 18;
    const Axis y(seconds, height - bottom, top);
    const std::string device = study.device.empty() ? "" : ", " + study.device + ", driver " + study.driver;
    std::string svg = svg::begin(width, height);
    svg += text(16, 26, "start", 18, ink, study.title) + text(16, 45, "start", 12, pale, subtitle + device);
    if (study.floor > 0) {  // errors that the reference cannot resolve
        const double end = x.at(study.floor);
        svg += rectangle(left, top, std::max(end - left, 0.0), height - bottom - top, "#f3f0e6");
    }
    svg += draw_axes(x, y, study);
    const std::vector<std::string> methods = methods_of(study);
    for (std::size_t i = 0; i < methods.size(); ++i) svg += draw_curve(study, methods[i], i, x, y);
    svg += draw_legend(methods, study.floor > 0 ? "shaded: below the error of the reference" : "");
    svg += draw_labels(study, x, y);
    return svg + "</svg>\n";
}

std::string html_of(const std::vector<Study>& studies, const std::string& title, const std::string& subtitle) {
    std::string html =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(title) +
        "</title>\n<style>body{font-family:sans-serif;max-width:64em;margin:2em auto;color:#222}table{border-collapse:"
        "collapse;font-size:13px}td,th{padding:2px 10px;border-bottom:1px solid "
        "#ddd;text-align:left}td.n{text-align:right;"
        "font-variant-numeric:tabular-nums}p{max-width:48em}</style></head><body>\n<h1>" +
        escaped(title) + "</h1>\n<p>" + escaped(subtitle) +
        "</p>\n"
        "<p>Every point is a setting: the median of its runs, with the quartiles as whiskers. Filled points are on the "
        "front: no other point is both faster and more accurate.</p>\n";
    if (const std::vector<std::string> summary = summary_of(studies); !summary.empty()) {
        html += "<h2>What matters most</h2>\n<ul>\n";
        for (const std::string& fact : summary) html += "<li>" + escaped(fact) + "</li>\n";
        html += "</ul>\n";
    }
    for (const Study& study : studies) {
        html += "<h2>" + escaped(study.title) + "</h2>\n" + (has_plot(study) ? svg_of(study, subtitle) : "");
        if (study.reference_spp != 0)
            html += "<p>Reference: " + std::to_string(study.reference_spp) + " samples per pixel, its own error " +
                    printed("%.3g", study.floor) + " of the mean, estimated from the spread of its renders.</p>\n";
        html += "<ul>\n";
        for (const std::string& finding : study.findings) html += "<li>" + escaped(finding) + "</li>\n";
        html += "</ul>\n" + (study.points.empty() ? "" : table_of(study));
    }
    return html + "</body></html>\n";
}

std::string csv_of(const std::vector<Study>& studies, const std::string& scene) {
    std::string csv =
        "device,driver,scene,study,method,setting,value,runs,error,error_low,error_high,relmse,perceptual,seconds,"
        "seconds_low,seconds_high,front,floor,failure,facts\n";
    const auto quoted = [](const std::string& words) {
        std::string out = "\"";
        for (const char c : words) out += c == '"' ? "\"\"" : std::string(1, c);
        return out + '"';
    };
    for (const Study& study : studies)
        for (const StudyPoint& p : study.points) {
            csv += quoted(study.device) + ',' + quoted(study.driver) + ',' + quoted(scene) + ',' + study.name + ',' +
                   quoted(p.method) + ',' + quoted(p.setting);
            for (const double v : {p.value, double(p.runs), p.error.median, p.error.low, p.error.high, p.errors.relmse,
                                   p.errors.perceptual, p.seconds.median, p.seconds.low, p.seconds.high,
                                   p.front ? 1.0 : 0.0, study.floor})
                csv += ',' + printed("%.6g", v);
            std::string facts;
            for (const auto& [name, value] : p.facts)
                facts += (facts.empty() ? "" : "; ") + name + " = " + printed("%.6g", value);
            csv += ',' + quoted(p.failure) + ',' + quoted(facts) + '\n';
        }
    return csv;
}

}  // namespace claray
