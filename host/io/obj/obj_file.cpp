#include "host/io/obj/obj_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <istream>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "claray/error.hpp"
#include "host/io/image/color.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/obj/obj_corner.hpp"
#include "host/io/obj/obj_lines.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using std::to_string;

/// The names of a line that parts them by blanks, in which a backslash may stand before a blank that is part of a name.
std::vector<std::string> names_of(std::string_view line) {
    std::vector<std::string> names;
    bool inside = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const bool escaped = line[i] == '\\' && i + 1 < line.size() && line[i + 1] == ' ';
        if (escaped) ++i;
        const bool part = escaped || (line[i] != ' ' && line[i] != '\t');
        if (part && !inside) names.emplace_back();
        if (part) names.back() += line[i];
        inside = part;
    }
    return names;
}

/// Reads the MTL files that the OBJ names, from the OBJ's folder or below.
class MtlReader : public tinyobj::MaterialReader {
public:
    MtlReader(const fs::path& obj, const ObjLines& lines, ObjFile& file, Warnings& warnings)
        : obj_(obj), folder_(obj.parent_path()), lines_(lines), file_(file), warnings_(warnings) {}

    // The parser asks for one name after the other until one is found. But the format wants all of them read, and a
    // name may hold blanks: so all is done at the first.
    bool operator()(const std::string&, std::vector<tinyobj::material_t>* materials, std::map<std::string, int>* map,
                    std::string*, std::string*) override {
        if (std::exchange(line_, lines_.line()) == lines_.line()) return false;
        names_any_ = true;
        std::string_view all = trim(trim(lines_.text()).substr(std::string_view("mtllib").size()));
        if (all.size() > 1 && all.front() == '"' && all.back() == '"') all = all.substr(1, all.size() - 2);
        if (is_file(std::string(all))) {
            load(std::string(all), *materials, *map);
            return true;
        }
        const std::vector<std::string> names = names_of(all);
        bool found = false;
        for (std::size_t i = 0, length = 0; i < names.size(); i += length) {
            const std::string name = longest_file(names, i, length);
            if (is_file(name)) {
                load(name, *materials, *map);
                found = true;
            } else {
                file_.lacks_mtl = true;
                warnings_.push_back("material file '" + (folder_ / name).string() +
                                    "' is missing: its materials are shown in grey");
            }
        }
        return found;
    }

    void warn_if_none_is_named() {
        if (names_any_ || file_.material_names.size() < 2) return;
        file_.lacks_mtl = true;
        warnings_.push_back("'" + obj_.string() + "' uses materials, " + claray::quoted(file_.material_names[1]) +
                            " for example, but has no mtllib line: they are shown in grey");
    }

private:
    [[nodiscard]] bool is_file(std::string name) const {
        if (!namesake_of(folder_, name).empty()) return true;
        std::replace(name.begin(), name.end(), '\\', '/');
        std::error_code error;
        return fs::is_regular_file(folder_ / name, error);
    }

    /// The longest name of a file that begins with names[begin], or that one; `length`: of how many it is made.
    [[nodiscard]] std::string longest_file(const std::vector<std::string>& names, std::size_t begin,
                                           std::size_t& length) const {
        constexpr std::size_t most_blanks = 16, many = 64;  // names without blanks, of so many on a line
        if (names.size() > many) return length = 1, names[begin];
        std::string longest = names[begin], joined = longest;
        length = 1;
        for (std::size_t i = begin + 1; i < std::min(names.size(), begin + most_blanks); ++i) {
            joined += ' ' + names[i];
            if (is_file(joined)) longest = joined, length = i + 1 - begin;
        }
        return longest;
    }

    void load(const std::string& name, std::vector<tinyobj::material_t>& materials, std::map<std::string, int>& map) {
        fs::path path = namesake_of(folder_, name);
        if (!path.empty()) warnings_.push_back(remark_of_namesake(obj_, name, path));
        path = path_in_scene(folder_, folder_, path.empty() ? name : path.filename().string(), obj_);
        const std::string mtl = with_joined_lines(read_text(path, "check its permissions"));
        const std::string shown = path.filename().string();
        std::istringstream text(adapted_to_tinyobj(mtl, shown, warnings_));
        std::string remarks, errors;
        const std::size_t known = materials.size();
        tinyobj::LoadMtl(&map, &materials, &text, &remarks, &errors);
        for (std::size_t i = known; i < materials.size(); ++i)  // the parser keeps blanks before it
            materials[i].name = std::string(trim(materials[i].name));
        file_.mtl_materials.insert(file_.mtl_materials.end(), materials.begin() + std::ptrdiff_t(known),
                                   materials.end());
        file_.mtl_folders.resize(materials.size(), path.parent_path());
        std::istringstream lines(remarks);
        for (std::string line; std::getline(lines, line);) warnings_.push_back(shown + ": " + line);
    }

    const fs::path& obj_;
    fs::path folder_;
    const ObjLines& lines_;
    ObjFile& file_;
    Warnings& warnings_;
    std::size_t line_ = 0;  // of the latest mtllib
    bool names_any_ = false;
};

/// Numbers of strings in the order in which they first appear.
class Names {
public:
    explicit Names(std::vector<std::string>& names) : names_(names) { static_cast<void>(number(std::string())); }
    std::uint32_t number(const std::string& name) {
        const auto [found, is_new] = numbers_.try_emplace(name, std::uint32_t(names_.size()));
        if (is_new) names_.push_back(name);
        return found->second;
    }

private:
    std::vector<std::string>& names_;
    std::unordered_map<std::string, std::uint32_t> numbers_;
};

/// Each group's name is that of its object, too: long ones would be copied often.
constexpr std::size_t longest_group_name = 1024;
std::string shortened(std::string_view name) { return std::string(name.substr(0, longest_group_name)); }

/// Receives the parser's callbacks.
class ObjReader {
public:
    ObjReader(const fs::path& path, ObjFile& file, ObjLines& lines)
        : path_(path), file_(file), lines_(lines), groups_(file.groups), materials_(file.material_names) {
        lines_.at_stroke = [this] { stroke(); };
    }

    static tinyobj::callback_t callbacks();
    void check_bare_lines() const;
    void check_forward_references(Warnings& warnings);
    void warn_of_bad_numbers(Warnings& warnings) const;
    void warn_of_left_out(Warnings& warnings) const;

private:
    /// The largest index of one kind so far, and where it stands: the format lets a face name a vertex of a later line.
    struct Largest {
        int index = -1;
        std::size_t line = 0;
        ObjLeftOut backwards;  ///< those that count backwards where there is nothing yet
    };

    /// What is not finite of one kind, and where the first stands.
    struct NotFinite {
        std::size_t count = 0, line = 0;
    };

    void check_numbers(std::span<float> numbers, std::size_t needed, NotFinite& not_finite);
    void vertex_color();
    void face();
    void stroke();
    [[nodiscard]] ObjIndices corner_in(std::string_view word, const char* of) const;
    [[nodiscard]] int resolve(int index, std::size_t count, const char* kind, Largest& largest);
    [[nodiscard]] int resolve_attribute(int index, std::size_t count, const char* kind, Largest& largest);
    [[noreturn]] void refuse(std::size_t line, const std::string& what, const std::string& remedy) const;
    [[noreturn]] void refuse_cut_off(std::size_t line, std::string_view keyword, std::size_t some,
                                     std::size_t needed) const;
    [[noreturn]] void out_of_range(std::size_t line, const char* kind, int index, std::size_t count) const;
    void enter_group() {
        const bool both = !object_.empty() && !group_name_.empty();
        group_ = groups_.number(object_ + (both ? "/" : "") + group_name_);
    }

    const fs::path& path_;
    ObjFile& file_;
    ObjLines& lines_;
    Names groups_, materials_;
    std::string object_, group_name_;
    std::uint32_t group_ = 0, material_ = 0;
    Largest positions_, uvs_, normals_;
    NotFinite bad_positions_, bad_uvs_, bad_normals_, bad_colors_;
};

/// `numbers` are those of the current line as the parser read them, which takes for 0 what is missing or no number, and
/// "nan" and "inf", too: that would move a vertex silently.
void ObjReader::check_numbers(std::span<float> numbers, std::size_t needed, NotFinite& not_finite) {
    std::string_view rest = lines_.text();
    const std::string_view keyword = next_word(rest);
    bool finite = true;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const std::string_view word = next_word(rest);
        if (word.empty() && k >= needed) break;
        if (word.empty()) refuse_cut_off(lines_.line(), keyword, k, needed);
        if (is_finite_number(word)) {
            if (std::isnan(numbers[k])) numbers[k] = 0.f;  // "0e999": the parser multiplies 0 by infinity
        } else if (const std::optional<float> value = not_finite_number(word)) {
            numbers[k] = *value;
        } else {
            refuse(lines_.line(), quoted(word) + " is not a number", "write numbers as in -1.5 or 2e-3");
        }
        finite &= std::isfinite(numbers[k]);
    }
    if (!finite && not_finite.count++ == 0) not_finite.line = lines_.line();
}

/// The colour of the latest vertex, where its line goes on after x y z by r g b. Encoded as sRGB, which is what
/// painting and scanning programs write. (A fourth number alone is a weight.)
void ObjReader::vertex_color() {
    std::string_view rest = lines_.text(), words[7];
    for (std::string_view& word : words) word = next_word(rest);
    const bool given = !words[6].empty();
    if (!given && file_.colors.empty()) return;
    glm::dvec3 color(1.0);
    for (int k = 0; given && k < 3; ++k) color[k] = number_in(words[4 + k]).value_or(NAN);
    const bool good = color == glm::clamp(color, 0.0, 1.0);  // not where it is NaN
    if (!good && bad_colors_.count++ == 0) bad_colors_.line = lines_.line();
    for (int k = 0; k < 3; ++k)
        if (std::isnan(color[k])) color = glm::dvec3(1.0);
    file_.colors.resize(file_.positions.size() - 1, glm::vec3(1.f));
    file_.colors.push_back(linear_from_display(color));
}

void ObjReader::refuse(std::size_t line, const std::string& what, const std::string& remedy) const {
    throw Error(ErrorKind::user, "'" + path_.string() + "' line " + to_string(line) + ": " + what, remedy);
}

void ObjReader::refuse_cut_off(std::size_t line, std::string_view keyword, std::size_t some, std::size_t needed) const {
    refuse(line,
           "'" + std::string(keyword) + "' with " + to_string(some) + " of " + to_string(needed) +
               (needed == 1 ? " number" : " numbers"),
           "the file may be cut off; export it again");
}

void ObjReader::out_of_range(std::size_t line, const char* kind, int index, std::size_t count) const {
    refuse(line, kind + (" index " + to_string(index)) + " is out of range, there are " + to_string(count),
           "indices count from 1, or backwards from -1; the file may be cut off");
}

// From the file's counting (1 is the first, -1 the latest) to ours.
int ObjReader::resolve(int index, std::size_t count, const char* kind, Largest& largest) {
    const std::int64_t resolved = index > 0 ? std::int64_t(index) - 1 : std::int64_t(count) + index;
    if (index == 0 || resolved < 0) out_of_range(lines_.line(), kind, index, count);
    if (resolved > largest.index) largest.index = int(resolved), largest.line = lines_.line();
    return int(resolved);
}

/// A file without any texture coordinates or normals may refer to them all the same: which it is shows at its end.
int ObjReader::resolve_attribute(int index, std::size_t count, const char* kind, Largest& largest) {
    if (index >= 0 || count > 0) return resolve(index, count, kind, largest);
    largest.backwards.add(kind, lines_.line());
    return -1;
}

ObjIndices ObjReader::corner_in(std::string_view word, const char* of) const {
    if (const std::optional<ObjIndices> corner = parse_corner(word)) return *corner;
    refuse(lines_.line(), quoted(word) + " is not a " + of,
           "write vertex, vertex/texture, vertex//normal or vertex/texture/normal, as indices of 'v', 'vt' and 'vn' "
           "lines");
}

/// Texture coordinates of lines are left out, because primitives have none.
void ObjReader::stroke() {
    std::string_view rest = lines_.text();
    const bool is_line = next_word(rest) == "l";
    std::optional<int> before;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
        const int end = resolve(corner_in(word, "point").position, file_.positions.size(), "vertex", positions_);
        if (!is_line || before) file_.strokes.push_back({before.value_or(end), end, material_});
        if (is_line) before = end;
    }
}

/// From the line itself: the parser takes for 0 what is no index, and has no room for one beyond 2^31.
void ObjReader::face() {
    std::string_view rest = lines_.text();
    static_cast<void>(next_word(rest));  // the "f"
    const std::size_t first = file_.corners.size();
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
        const ObjIndices raw = corner_in(word, "corner of a face");
        ObjCorner corner;
        corner.position = resolve(raw.position, file_.positions.size(), "vertex", positions_);
        if (raw.uv) corner.uv = resolve_attribute(raw.uv, file_.uvs.size(), "texture", uvs_);
        if (raw.normal) corner.normal = resolve_attribute(raw.normal, file_.normals.size(), "normal", normals_);
        file_.corners.push_back(corner);
    }
    const std::size_t count = file_.corners.size() - first;
    if (count < 3) {
        file_.corners.resize(first);
        ++file_.degenerate_faces;
    } else {
        file_.polygons.push_back({first, std::uint32_t(count), group_, material_});
    }
}

void ObjReader::check_bare_lines() const {
    const ObjLines::Bare& bare = lines_.bare();
    if (bare.line != 0) refuse_cut_off(bare.line, bare.keyword, 0, bare.keyword == "vt" ? 1 : 3);
}

void ObjReader::check_forward_references(Warnings& warnings) {
    const auto check = [&](const Largest& largest, std::size_t count, const char* kind) {
        if (largest.index >= 0 && std::size_t(largest.index) >= count)
            out_of_range(largest.line, kind, largest.index + 1, count);
        if (largest.backwards.count > 0) out_of_range(largest.backwards.line, kind, -1, 0);
    };
    const auto check_attribute = [&](const Largest& largest, std::size_t count, const char* kind, const char* all,
                                     int ObjCorner::*of) {
        if (count > 0 || (largest.index < 0 && largest.backwards.count == 0)) return check(largest, count, kind);
        warnings.push_back("'" + path_.string() + "': faces refer to " + all +
                           ", but there are none: they are ignored");
        for (ObjCorner& corner : file_.corners) corner.*of = -1;
    };
    check(positions_, file_.positions.size(), "vertex");
    check_attribute(uvs_, file_.uvs.size(), "texture", "texture coordinates", &ObjCorner::uv);
    check_attribute(normals_, file_.normals.size(), "normal", "normals", &ObjCorner::normal);
}

void ObjReader::warn_of_left_out(Warnings& warnings) const {
    const auto warn = [&](ObjStatement kind, const char* consequence) {
        const ObjLeftOut& left_out = lines_.left_out(kind);
        if (left_out.count == 0) return;
        const std::string more = left_out.count > 1 ? " (and " + to_string(left_out.count - 1) + " more)" : "";
        warnings.push_back("'" + path_.string() + "' line " + to_string(left_out.line) + more + ": " +
                           claray::quoted(left_out.keyword) + consequence);
    };
    warn(ObjStatement::free_form, " is ignored: no free-form curves and surfaces are shown");
    const auto is_flat = [](const ObjCorner& corner) { return corner.normal < 0; };
    if (std::any_of(file_.corners.begin(), file_.corners.end(), is_flat))
        warn(ObjStatement::smoothing, " (a smoothing group) is ignored: faces without normals are flat");
    warn(ObjStatement::unknown, " is not an OBJ statement: the line is ignored");
}

void ObjReader::warn_of_bad_numbers(Warnings& warnings) const {
    const auto warn = [&](const NotFinite& bad, const char* fault, const char* consequence) {
        if (bad.count == 0) return;
        const std::string more = bad.count > 1 ? " (and " + to_string(bad.count - 1) + " more)" : "";
        warnings.push_back("'" + path_.string() + "' line " + to_string(bad.line) + more + ": a " + fault + ": " +
                           consequence);
    };
    warn(bad_positions_, "vertex is not finite", "its triangles are left out");
    warn(bad_uvs_, "texture coordinate is not finite", "0 is used");
    warn(bad_normals_, "normal is not finite", "the normal of the face is used");
    warn(bad_colors_, "vertex has a colour that is not three numbers in 0..1", "it is clamped, or replaced by white");
}

tinyobj::callback_t ObjReader::callbacks() {
    using tinyobj::real_t;
    static constexpr auto self = [](void* reader) -> ObjReader& { return *static_cast<ObjReader*>(reader); };
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* r, real_t x, real_t y, real_t z, real_t) {
        std::array<float, 3> p = {x, y, z};
        self(r).check_numbers(p, 3, self(r).bad_positions_);
        self(r).file_.positions.emplace_back(p[0], p[1], p[2]);
        self(r).vertex_color();
    };
    callback.normal_cb = [](void* r, real_t x, real_t y, real_t z) {
        std::array<float, 3> n = {x, y, z};
        self(r).check_numbers(n, 3, self(r).bad_normals_);
        self(r).file_.normals.emplace_back(n[0], n[1], n[2]);
    };
    callback.texcoord_cb = [](void* r, real_t u, real_t v, real_t) {
        std::array<float, 2> uv = {u, v};
        self(r).check_numbers(uv, 1, self(r).bad_uvs_);
        self(r).file_.uvs.emplace_back(uv[0], uv[1]);
    };
    callback.index_cb = [](void* r, tinyobj::index_t*, int) { self(r).face(); };
    callback.usemtl_cb = [](void* r, const char* name, int) {
        self(r).material_ = self(r).materials_.number(std::string(trim(name)));
    };
    callback.group_cb = [](void* r, const char** names, int count) {
        self(r).group_name_.clear();
        for (int i = 0; i < count && self(r).group_name_.size() < longest_group_name; ++i)
            self(r).group_name_ += (i ? " " : "") + shortened(names[i]);
        self(r).enter_group();
    };
    callback.object_cb = [](void* r, const char* name) {
        self(r).object_ = shortened(trim(name));
        self(r).group_name_.clear();
        self(r).enter_group();
    };
    return callback;
}

}  // namespace

ObjFile read_obj(const fs::path& path, Warnings& warnings) {
    std::string text = read_text(path, "check the path");
    if (text.empty()) throw Error(ErrorKind::user, "'" + path.string() + "' is empty", "export the mesh again");
    ObjFile file;
    ObjLines lines(std::move(text));
    std::istream stream(&lines);
    stream.exceptions(std::ios::badbit);  // what `at_stroke` throws goes on
    ObjReader reader(path, file, lines);
    MtlReader mtl_reader(path, lines, file, warnings);
    tinyobj::LoadObjWithCallback(stream, ObjReader::callbacks(), &reader, &mtl_reader);
    reader.check_bare_lines();
    reader.check_forward_references(warnings);
    reader.warn_of_bad_numbers(warnings);
    reader.warn_of_left_out(warnings);
    mtl_reader.warn_if_none_is_named();
    if (file.polygons.empty() && file.strokes.empty())  // a cloud of points, as scanners write them
        for (int i = 0; i < int(file.positions.size()); ++i) file.strokes.push_back({i, i, 0});
    if (file.polygons.empty() && file.strokes.empty())
        throw Error(ErrorKind::user, "'" + path.string() + "' contains neither faces nor points",
                    "claray needs lines of 'f' or 'v'; export a mesh");
    return file;
}

}  // namespace claray
