#include "tests/fuzz/forge_formats.hpp"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tests/support/png.hpp"

namespace claray::test {
namespace {

using nlohmann::json;

FileBytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// The same on every platform, which standard distributions are not.
class Random {
public:
    explicit Random(std::uint32_t number) : engine_(number) {}
    std::uint32_t below(std::size_t end) { return std::uint32_t(engine_() % std::max<std::size_t>(end, 1)); }
    bool one_in(unsigned count) { return below(count) == 0; }
    template <class T, std::size_t N>
    const T& of(const T (&values)[N]) {
        return values[below(N)];
    }
    std::string bytes(std::size_t count) {
        std::string text;
        while (text.size() < count) text += char(engine_());
        return text;
    }

private:
    std::mt19937 engine_;
};

std::uint32_t little_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::uint8_t(bytes[i]);
    return value;
}
std::string little_endian(std::size_t value) {
    return {char(value & 255), char(value >> 8 & 255), char(value >> 16 & 255), char(value >> 24 & 255)};
}

/// A glTF's JSON, and what a .glb has behind it.
struct GltfText {
    std::string json, rest;
    bool binary = false;
};

GltfText parts_of(std::span<const std::uint8_t> file) {
    const std::string text(file.begin(), file.end());
    constexpr std::size_t header = 20;
    if (!text.starts_with("glTF") || text.size() < header) return {text, {}, false};
    const std::size_t length =
        std::min<std::size_t>(little_endian(std::string_view(text).substr(12)), text.size() - header);
    return {text.substr(header, length), text.substr(header + length), true};
}

std::string joined(GltfText parts) {
    if (!parts.binary) return parts.json;
    parts.json.resize((parts.json.size() + 3) / 4 * 4, ' ');
    const std::string chunks = little_endian(parts.json.size()) + "JSON" + parts.json + parts.rest;
    return "glTF" + little_endian(2) + little_endian(chunks.size() + 12) + chunks;
}

/// All values of a document, parents first.
void collect(json& value, std::vector<json*>& all) {
    all.push_back(&value);
    if (value.is_structured())
        for (json& child : value) collect(child, all);
}

json edge_value(Random& random) {
    switch (random.below(14)) {
        case 0: return -1;
        case 1: return 0;
        case 2: return 1;
        case 3: return 2147483647;
        case 4: return 4294967296;
        case 5: return -9223372036854775807;
        case 6: return 1e308;
        case 7: return 0.5;
        case 8: return nullptr;
        case 9: return json::array();
        case 10: return json::object();
        case 11: return true;
        case 12: return std::string(random.below(600), 'x');
        default: return random.below(300);
    }
}

void change(json& document, Random& random) {
    std::vector<json*> all;
    collect(document, all);
    json& value = *all[random.below(all.size())];
    const json other = *all[random.below(all.size())];
    switch (random.below(8)) {
        case 0:
        case 1: value = edge_value(random); break;
        case 2: value = other; break;
        case 3:
            if (value.is_array() && !value.empty()) value.push_back(value[random.below(value.size())]);
            break;
        case 4:
            if (value.is_structured() && !value.empty()) {
                auto at = value.begin();
                std::advance(at, random.below(value.size()));
                value.erase(at);
            }
            break;
        case 5:
            if (value.is_object()) value["extensions"] = other;
            break;
        default:  // a number that is a little off
            for (std::size_t tries = 0; tries < 20; ++tries) {
                json& number = *all[random.below(all.size())];
                if (!number.is_number_integer()) continue;
                number = number.get<std::int64_t>() + (random.one_in(2) ? 1 : -1) * std::int64_t(1 + random.below(4));
                break;
            }
    }
}

std::vector<std::string> split(const std::string& text, char by) {
    std::vector<std::string> parts(1);
    for (const char c : text)
        if (c == by)
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

std::string join(const std::vector<std::string>& parts, const std::string& by) {
    std::string text;
    for (std::size_t i = 0; i < parts.size(); ++i) text += (i ? by : "") + parts[i];
    return text;
}

constexpr const char* odd_words[] = {
    "0",     "-1",     "1",       "2147483647", "-2147483648", "4294967296", "1e999",        "-1e-999",  "nan",
    "inf",   "1.#IND", "0x10",    "",           "-",           ".",          "1/1/1",        "-1//1",    "1/",
    "//",    "/",      "1/2/3/4", "-o",         "-s",          "-bm",        "-clamp",       "-imfchan", "-mm",
    "-halo", "../x",   "C:\\x",   "\\",         "#",           "\"",         "\xef\xbb\xbf", "\x1b[0m",  "\xff"};
constexpr const char* odd_lines[] = {"v",
                                     "vt",
                                     "vn",
                                     "f",
                                     "f 1 2",
                                     "usemtl",
                                     "mtllib",
                                     "mtllib \\",
                                     "newmtl",
                                     "newmtl ",
                                     "map_Kd",
                                     "map_Kd -o 1",
                                     "illum 99999999",
                                     "Tr 2",
                                     "d -1",
                                     "Ns 1e38",
                                     "g a b c",
                                     "o",
                                     "s off",
                                     "l 1 2",
                                     "p 1",
                                     "norm x.png",
                                     "bump -bm",
                                     "Kd",
                                     "Kd xyz 1 1",
                                     "Kd spectral a",
                                     "Ke 1e38 1 nan",
                                     "f 1 1 1 1 1 1 1 1 1 1",
                                     "v 1 2 3 4 5 6 7 8 9",
                                     "v 1e38 -1e38 1e-45",
                                     "usemtl a\\",
                                     "call x.obj",
                                     "\\"};

void change(std::vector<std::string>& lines, Random& random) {
    const std::size_t at = random.below(lines.size());
    switch (random.below(8)) {
        case 0: lines.insert(lines.begin() + std::ptrdiff_t(at), random.of(odd_lines)); break;
        case 1: lines.insert(lines.begin() + std::ptrdiff_t(at), lines[random.below(lines.size())]); break;
        case 2: lines[at].clear(); break;
        case 3: lines[at] += '\\'; break;
        case 4: std::swap(lines[at], lines[random.below(lines.size())]); break;
        default: {
            std::vector<std::string> words = split(lines[at], ' ');
            words[random.below(words.size())] = random.of(odd_words);
            if (random.one_in(4)) words.push_back(random.of(odd_words));
            lines[at] = join(words, random.one_in(8) ? "\t" : " ");
        }
    }
}

}  // namespace

FileBytes forged_png(std::uint32_t number) {
    Random random(number);
    constexpr unsigned depths[] = {1, 2, 4, 8, 8, 16, 16, 3}, types[] = {0, 2, 3, 3, 4, 6, 6, 5};
    RawPng png;
    png.width = 1 + random.below(48), png.height = 1 + random.below(48);
    png.depth = random.of(depths), png.color_type = random.of(types), png.interlaced = random.one_in(2);
    if (png.color_type == 3 || random.one_in(4)) png.palette = random.bytes(random.one_in(4) ? random.below(800) : 768);
    if (random.one_in(3)) png.transparency = random.bytes(random.below(260));
    // Rows of any filter, of about the length that the header promises.
    constexpr unsigned channels[] = {1, 0, 3, 1, 2, 1, 4};
    const std::size_t row = 1 + (std::size_t(png.width) * channels[png.color_type] * png.depth + 7) / 8;
    std::string raw = random.bytes(png.height * row * (png.interlaced ? 2 : 1) + random.below(3));
    for (std::size_t i = 0; i < raw.size(); ++i)
        if (!random.one_in(64)) raw[i] = char(i % row == 0 ? random.below(5) : std::uint8_t(raw[i]));
    if (random.one_in(4)) raw.resize(random.below(raw.size()));
    const std::string pixels = random.one_in(8) ? zeros_zlib(1 + random.below(1u << 20)) : stored_zlib(raw);
    FileBytes file = bytes_of(png.file_with(pixels));
    if (random.one_in(3)) {  // a chunk more
        constexpr const char* kinds[] = {"IDAT", "PLTE", "tRNS", "IHDR", "IEND",
                                         "gAMA", "zTXt", "iCCP", "eXIf", "abcd"};
        const FileBytes chunk = bytes_of(png_chunk(random.of(kinds), random.bytes(random.below(64))));
        constexpr std::size_t behind_header = 33;
        const std::size_t at = random.one_in(2) ? behind_header : file.size() - 12;
        file.insert(file.begin() + std::ptrdiff_t(at), chunk.begin(), chunk.end());
    }
    if (random.one_in(2)) file = forged(file, number, 33);
    mend_png(file);
    return file;
}

FileBytes forged_gltf(std::span<const std::uint8_t> good, std::uint32_t number) {
    Random random(number);
    GltfText parts = parts_of(good);
    json document = json::parse(parts.json);
    for (unsigned changes = 1 + random.below(4); changes != 0; --changes) change(document, random);
    parts.json = document.dump(-1, ' ', false, json::error_handler_t::replace);
    if (parts.binary && parts.rest.size() > 16 && random.one_in(3)) {
        const FileBytes changed = forged(bytes_of(parts.rest.substr(8)), number, 0);
        parts.rest =
            little_endian(changed.size()) + parts.rest.substr(4, 4) + std::string(changed.begin(), changed.end());
    }
    return bytes_of(joined(parts));
}

FileBytes forged_text(std::span<const std::uint8_t> good, std::uint32_t number) {
    Random random(number);
    std::vector<std::string> lines = split(std::string(good.begin(), good.end()), '\n');
    for (unsigned changes = 1 + random.below(6); changes != 0; --changes) change(lines, random);
    constexpr const char* ends[] = {"\n", "\n", "\n", "\n", "\r\n", "\r", "\n\r", "\\\n"};
    std::string text = join(lines, random.of(ends));
    if (random.one_in(16)) text = "\xef\xbb\xbf" + text;
    if (random.one_in(16)) text.resize(random.below(text.size()));
    return bytes_of(text);
}

std::uint64_t promised_zeros(std::span<const std::uint8_t> gltf) {
    const json document = json::parse(parts_of(gltf).json, nullptr, false);
    std::uint64_t bytes = 0;
    if (!document.is_object() || !document.contains("accessors")) return 0;
    for (const json& accessor : document["accessors"]) {
        if (!accessor.is_object() || accessor.contains("bufferView") || !accessor.contains("count")) continue;
        const json& count = accessor["count"];
        constexpr double most = double(1u << 24), floats = 16;  // beyond that they are refused
        if (count.is_number() && count.get<double>() > 0 && count.get<double>() <= most)
            bytes += std::uint64_t(count.get<double>() * floats);
    }
    return bytes;
}

}  // namespace claray::test
