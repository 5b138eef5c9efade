#include "host/cli/output/verify_html.hpp"

#include "host/accuracy/svg.hpp"
#include "host/base/format.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

using svg::escaped;

std::string svg_of(const VerifyPicture& picture) {
    std::string svg = "<figure><svg viewBox=\"0 0 1 1\" width=\"420\" height=\"420\">";
    for (const VerifyPicture::Shape& shape : picture.shapes) {
        const std::string color = printed("#%06x", unsigned(shape.color));
        if (shape.points.size() == 2) {
            svg += printed("<circle cx=\"%g\" cy=\"%g\" r=\"0.006\" fill=\"", double(shape.points[0]),
                           double(1 - shape.points[1])) +
                   color + "\"/>";
            continue;
        }
        const bool closed = shape.filled || shape.points.size() == 6;
        svg += closed ? "<polygon points=\"" : "<polyline points=\"";
        for (std::size_t i = 0; i + 1 < shape.points.size(); i += 2)
            svg += printed("%g,%g ", double(shape.points[i]), double(1 - shape.points[i + 1]));
        svg += std::string("\" fill=\"") + (shape.filled ? color : "none") + "\" stroke=\"" + color +
               "\" stroke-width=\"0.002\"/>";
    }
    return svg + "</svg><figcaption>" + escaped(picture.title) + "</figcaption></figure>";
}

std::string rows_of(const VerifyResult& result) {
    std::string rows;
    for (const VerifyCheck& c : result.checks)
        rows += std::string("<tr class=\"") + (c.holds() ? "" : "bad") + "\"><td>" + escaped(result.name) + "<td>" +
                escaped(c.what) + "<td>" + std::to_string(c.tried) + "<td>" + number(c.worst) + "<td>" + number(c.bar) +
                "<td>" + escaped(c.unit) + "<td>" + (c.holds() ? "holds" : "FAILS") + "<td>" +
                fixed(result.seconds, 2) + "\n";
    return rows;
}

}  // namespace

std::string html_of(const DeviceInfo& device, std::span<const VerifyResult> results) {
    std::size_t failed = 0;
    std::string rows, details;
    for (const VerifyResult& result : results) {
        rows += rows_of(result);
        if (!result.facts.empty() || !result.holds()) details += "<h2>" + escaped(result.name) + "</h2>\n";
        for (const auto& [name, value] : result.facts)
            details += "<p>" + escaped(name) + ": <code>" + escaped(value) + "</code>\n";
        if (result.holds()) continue;
        ++failed;
        details += "<p>Again: <code>" + escaped(result.command) + "</code>\n";
        for (const std::string& failure : result.failures) details += "<p><code>" + escaped(failure) + "</code>\n";
        for (const VerifyPicture& picture : result.pictures) details += svg_of(picture);
    }
    return "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>claray verify</title>\n"
           "<style>body{font:15px sans-serif;max-width:75em;margin:2em auto}table{border-collapse:collapse}"
           "td,th{padding:.2em .6em;border-bottom:1px solid #ddd;text-align:left}.bad{background:#fbd5cc}"
           "figure{display:inline-block;border:1px solid "
           "#ccc;padding:.5em}code{word-break:break-all}</style>\n<h1>claray verify</h1>\n<p>" +
           escaped(device.name) + ", driver " + escaped(device.driver) + ": " +
           (failed == 0 ? "all " + std::to_string(results.size()) + " cases hold"
                        : std::to_string(failed) + " of " + std::to_string(results.size()) + " cases fail") +
           "\n<table><tr><th>case<th>figure<th>tried<th>worst<th>bar<th>unit<th>verdict<th>seconds\n" + rows +
           "</table>\n" + details + "</html>\n";
}

}  // namespace claray::cli
