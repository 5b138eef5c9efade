#include "host/compute/programs/kernel_sources.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "claray/error.hpp"
#include "host/base/hash.hpp"

namespace claray {
namespace {

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file || text.fail()) throw Error(ErrorKind::user, "cannot read the kernel " + path.string());
    return text.str();
}

bool is_part_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Drivers need not know `#pragma once`: a guard takes its place, and no line moves.
std::string with_guard(const std::string& path, std::string text) {
    const std::string once = "#pragma once\n";
    const std::size_t at = text.find(once);
    if (at == std::string::npos) return text;
    std::string guard = "CLARAY_ONCE_" + path;
    std::replace_if(
        guard.begin(), guard.end(), [](char c) { return !is_part_of_name(c); }, '_');
    return text.replace(at, once.size(), "#ifndef " + guard + '\n') + "\n#define " + guard + "\n#endif\n";
}

std::vector<KernelSource> with_guards(std::vector<KernelSource> sources) {
    for (KernelSource& source : sources) source.text = with_guard(source.path, std::move(source.text));
    return sources;
}

/// Adds the files of the folder that the program does not have.
void add_new_files(std::vector<KernelSource>& sources, const std::filesystem::path& kernels) {
    std::unordered_set<std::string> known;
    for (const KernelSource& source : sources) known.insert(source.path);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kernels)) {
        const std::string extension = entry.path().extension();
        if (extension != ".cl" && extension != ".clh") continue;
        const std::string path = entry.path().lexically_relative(kernels).generic_string();
        if (!known.contains(path) && !path.starts_with("probes/")) sources.push_back({path, read_text(entry.path())});
    }
}

std::vector<KernelSource> sources_in_force() {
    std::vector<KernelSource> sources = embedded_kernel_sources();
    const char* override_dir = std::getenv("CLARAY_KERNEL_DIR");
    if (override_dir == nullptr || *override_dir == '\0') return sources;
    namespace fs = std::filesystem;
    const fs::path kernels = fs::weakly_canonical(override_dir);  // so that "kernels/" has the right parent
    if (!fs::is_directory(kernels))
        throw Error(ErrorKind::user, "CLARAY_KERNEL_DIR: no folder " + kernels.string(),
                    "set it to the folder kernels of claray, or unset it");
    bool any = false;
    for (KernelSource& source : sources) {
        const bool shared = source.path.starts_with("claray/");
        const fs::path file = (shared ? kernels.parent_path() / "include" : kernels) / source.path;
        if (!fs::exists(file)) continue;
        source.text = read_text(file);
        any = any || !shared;
    }
    if (!any)
        throw Error(ErrorKind::user, "CLARAY_KERNEL_DIR: no kernels of claray in " + kernels.string(),
                    "set it to the folder kernels of claray, or unset it");
    add_new_files(sources, kernels);
    return sources;
}

}  // namespace

namespace {

std::vector<KernelSource>& changeable_sources() {
    static std::vector<KernelSource> sources = with_guards(sources_in_force());
    return sources;
}

unsigned replaced = 0;
std::string original_hash;  // of the texts before the first replacement

}  // namespace

const std::vector<KernelSource>& kernel_sources() { return changeable_sources(); }

void replace_kernel_source(const std::string& path, std::string text) {
    if (replaced == 0) original_hash = hash_of_kernel_sources();
    for (KernelSource& source : changeable_sources())
        if (source.path == path) source.text = with_guard(path, std::move(text));
    ++replaced;
}

unsigned kernel_sources_replaced() { return replaced; }

bool has_own_kernel_sources() { return replaced > 0 && hash_of_kernel_sources() != original_hash; }

std::string hash_of_kernel_sources() {
    static std::mutex mutex;
    static std::string hash;
    static unsigned of = 0;  // its number of replacements
    const std::lock_guard lock(mutex);
    if (!hash.empty() && of == replaced) return hash;
    std::string all;
    for (const KernelSource& source : kernel_sources()) all += source.path + '\n' + source.text + '\n';
    of = replaced;
    return hash = hash128(all);
}

const KernelSource& kernel_source(const std::string& path) {
    for (const KernelSource& source : kernel_sources())
        if (source.path == path) return source;
    throw Error(ErrorKind::usage, "no kernel file " + path);
}

namespace {

/// In the order of their first occurrence; names that are not files of claray are left to the compiler.
void add_included(const std::string& text, std::vector<const KernelSource*>& found) {
    const std::string directive = "#include \"";
    for (std::size_t at = 0; (at = text.find(directive, at)) != std::string::npos;) {
        at += directive.size();
        const std::string path = text.substr(at, text.find('"', at) - at);
        const auto named = [&](const auto& source) { return source.path == path; };
        const auto& all = kernel_sources();
        const auto source = std::find_if(all.begin(), all.end(), named);
        if (source == all.end()) continue;
        if (std::find(found.begin(), found.end(), &*source) != found.end()) continue;
        found.push_back(&*source);
        add_included(source->text, found);
    }
}

}  // namespace

std::vector<const KernelSource*> included_sources(const std::string& text) {
    std::vector<const KernelSource*> found;
    add_included(text, found);
    return found;
}

namespace {

/// The names and numbers of a text, outside of comments.
std::unordered_set<std::string_view> words_of(std::string_view text) {
    std::unordered_set<std::string_view> words;
    for (std::size_t at = 0; at < text.size();) {
        std::size_t end = at;
        while (end < text.size() && is_part_of_name(text[end])) ++end;
        if (end > at)
            words.insert(text.substr(at, end - at));
        else
            end = text.substr(at, 2) == "//" ? std::min(text.find('\n', at), text.size()) : at + 1;
        at = end;
    }
    return words;
}

/// What is known of the texts in use, so that each is read once. Threads that load kernels share it.
struct KnownTexts {
    std::mutex mutex;
    using Words = std::unordered_set<std::string_view>;
    std::unordered_map<const KernelSource*, Words> own, with_included;
    unsigned replaced = 0;  // the number of replacements when they were read
};

/// The known texts, locked, without the texts of before a replacement.
std::pair<KnownTexts&, std::unique_lock<std::mutex>> known_texts() {
    static KnownTexts known;
    std::unique_lock lock(known.mutex);
    if (known.replaced != replaced) known.own.clear(), known.with_included.clear();
    known.replaced = replaced;
    return {known, std::move(lock)};
}

const KnownTexts::Words& own_words(KnownTexts& known, const KernelSource& source) {
    const auto [entry, is_new] = known.own.try_emplace(&source);
    if (is_new) entry->second = words_of(source.text);
    return entry->second;
}

}  // namespace

bool mentions(const KernelSource& source, const std::string& macro) {
    const auto [known, lock] = known_texts();
    return own_words(known, source).contains(macro);
}

bool needs(const KernelSource& source, const std::string& macro) {
    const auto [known, lock] = known_texts();
    const auto [entry, is_new] = known.with_included.try_emplace(&source);
    if (is_new) {
        entry->second = own_words(known, source);
        for (const KernelSource* text : included_sources(source.text)) {
            const KnownTexts::Words& words = own_words(known, *text);
            entry->second.insert(words.begin(), words.end());
        }
    }
    return entry->second.contains(macro);
}

std::string digest_of_texts(const KernelSource& main) {
    static std::mutex mutex;
    static std::map<std::string, std::string> digests;
    const std::string key = hash128(main.text) + std::to_string(replaced);
    const std::lock_guard lock(mutex);
    std::string& digest = digests[key];
    if (!digest.empty()) return digest;
    std::string texts = main.text + '\n';
    for (const KernelSource* source : included_sources(main.text)) texts += source->path + '\n' + source->text + '\n';
    return digest = hash128(texts);
}

std::string with_names_apart(std::string text) {
    const std::string directive = "#include \"";
    for (const KernelSource* source : included_sources(text)) {
        const std::string from = directive + source->path + '"', to = directive + names_apart + source->path + '"';
        for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
            text.replace(at, from.size(), to);
    }
    return text;
}

std::vector<KernelSource> headers_apart(const std::string& text) {
    std::vector<KernelSource> headers;
    for (const KernelSource* source : included_sources(text))
        headers.push_back({names_apart + source->path, with_names_apart(source->text)});
    return headers;
}

HeaderFolder::HeaderFolder(const std::vector<KernelSource>& files) {
    namespace fs = std::filesystem;
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "claray-headers-XXXXXX").string();
    if (error || ::mkdtemp(name.data()) == nullptr) return;
    path_ = name;
    for (const KernelSource& file : files) {
        fs::create_directories((path_ / file.path).parent_path(), error);
        std::ofstream out(path_ / file.path, std::ios::binary);
        out << file.text;
        if (out.flush()) continue;
        fs::remove_all(path_, error);
        path_.clear();
        return;
    }
}

HeaderFolder::~HeaderFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace claray
