#include "host/io/pbrt/pbrt_tokens.hpp"

#include "host/io/scene_textures.hpp"
#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr std::size_t most_includes = 32;                // one within the other
constexpr std::size_t most_text = std::size_t(4) << 30;  // of all files
constexpr std::string_view word_ends = " \t\n\"[]#";

}  // namespace

PbrtTokens::PbrtTokens(const std::filesystem::path& path) : root_(path), last_path_(path) { open(path); }

void PbrtTokens::open(const std::filesystem::path& path) {
    auto file = std::make_unique<File>();
    file->path = path;
    file->text = claray::read_text(path, "check the path");
    bytes_ += file->text.size();
    if (bytes_ > most_text) refuse("the scene's files have more than 4 GiB", "split the scene");
    files_.push_back(std::move(file));
}

void PbrtTokens::include(const std::string& name) {
    if (has_ahead_) refuse("a file is included amid a statement", "include files between statements");
    if (files_.size() > most_includes) refuse("files include each other more than 32 deep", "check for a loop");
    const std::filesystem::path path = path_in_scene(root_.parent_path(), root_.parent_path(), name, root_);
    if (path.extension() == ".gz") refuse("'" + path.string() + "' is compressed", "unpack it first");
    open(path);
}

std::string PbrtTokens::place() const { return "'" + last_path_.string() + "' line " + std::to_string(last_line_); }

void PbrtTokens::refuse(const std::string& what, const std::string& remedy) const {
    throw Error(ErrorKind::user, place() + ": " + what, remedy);
}

PbrtToken PbrtTokens::read_text(File& file) {
    PbrtToken token{PbrtToken::Kind::text, {}, file.line};
    for (++file.at; file.at < file.text.size() && file.text[file.at] != '"'; ++file.at) {
        char c = file.text[file.at];
        if (c == '\n') break;
        if (c == '\\' && file.at + 1 < file.text.size()) c = file.text[++file.at];
        token.value += c;
    }
    last_path_ = file.path, last_line_ = token.line;
    if (file.at >= file.text.size() || file.text[file.at] != '"')
        refuse("a text does not end", "add the quotation mark");
    ++file.at;
    return token;
}

PbrtToken PbrtTokens::read() {
    while (!files_.empty()) {
        File& file = *files_.back();
        while (file.at < file.text.size()) {
            const char c = file.text[file.at];
            if (c == '\n') {
                ++file.line, ++file.at;
            } else if (c == ' ' || c == '\t') {
                ++file.at;
            } else if (c == '#') {
                file.at = std::min(file.text.find('\n', file.at), file.text.size());
            } else {
                break;
            }
        }
        if (file.at >= file.text.size()) {
            files_.pop_back();
            continue;
        }
        const char c = file.text[file.at];
        if (c == '"') return read_text(file);
        PbrtToken token{PbrtToken::Kind::word, {}, file.line};
        if (c == '[' || c == ']') {
            token.kind = c == '[' ? PbrtToken::Kind::begin_list : PbrtToken::Kind::end_list;
            ++file.at;
        } else {
            const std::size_t end = std::min(file.text.find_first_of(word_ends, file.at), file.text.size());
            token.value = file.text.substr(file.at, end - file.at);
            file.at = end;
        }
        last_path_ = file.path, last_line_ = token.line;
        return token;
    }
    return {};
}

PbrtToken PbrtTokens::next() {
    if (!has_ahead_) return read();
    has_ahead_ = false;
    return std::move(ahead_);
}

const PbrtToken& PbrtTokens::peek() {
    if (!has_ahead_) ahead_ = read(), has_ahead_ = true;
    return ahead_;
}

double PbrtTokens::number_of(const PbrtToken& token) const {
    const auto number = token.kind == PbrtToken::Kind::word ? number_in(token.value) : std::nullopt;
    if (!number) refuse("a number is expected instead of " + claray::quoted(token.value), "check the statement");
    return *number;
}

double PbrtTokens::next_number() { return number_of(next()); }

std::string PbrtTokens::next_text() {
    PbrtToken token = next();
    if (token.kind != PbrtToken::Kind::text)
        refuse("a text in quotation marks is expected instead of " + claray::quoted(token.value),
               "check the statement");
    return std::move(token.value);
}

}  // namespace claray
