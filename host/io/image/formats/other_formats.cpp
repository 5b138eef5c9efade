#include "host/io/image/formats/other_formats.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

using namespace std::string_view_literals;

enum class Remedy { png, exr, ktx, svg, archive, download, lfs };

struct ImageSignature {
    std::string_view bytes;
    std::size_t at;
    const char* name;
    Remedy remedy;
};

constexpr ImageSignature image_signatures[] = {
    {"GIF8"sv, 0, "a GIF image", Remedy::png},
    {"II*\0"sv, 0, "a TIFF image", Remedy::exr},
    {"MM\0*"sv, 0, "a TIFF image", Remedy::exr},
    {"II+\0"sv, 0, "a BigTIFF image", Remedy::exr},
    {"MM\0+"sv, 0, "a BigTIFF image", Remedy::exr},
    {"\xabKTX 11\xbb"sv, 0, "a KTX texture", Remedy::ktx},
    {"sB"sv, 0, "a Basis texture", Remedy::ktx},
    {"DDS "sv, 0, "a DDS texture", Remedy::png},
    {"8BPS"sv, 0, "a Photoshop image (PSD)", Remedy::png},
    {"ftypavif"sv, 4, "an AVIF image", Remedy::png},
    {"ftypavis"sv, 4, "an AVIF animation", Remedy::png},
    {"ftypheic"sv, 4, "a HEIC image", Remedy::png},
    {"ftypheix"sv, 4, "a HEIC image", Remedy::png},
    {"ftypmif1"sv, 4, "a HEIF image", Remedy::png},
    {"ftypcrx "sv, 4, "a raw photograph", Remedy::exr},
    {"\0\0\0\x0cJXL "sv, 0, "a JPEG XL image", Remedy::png},
    {"\xff\x0a"sv, 0, "a JPEG XL image", Remedy::png},
    {"\0\0\0\x0cjP  "sv, 0, "a JPEG 2000 image", Remedy::png},
    {"\xff\x4f\xff\x51"sv, 0, "a JPEG 2000 image", Remedy::png},
    {"II\xbc"sv, 0, "a JPEG XR image", Remedy::png},
    {"qoif"sv, 0, "a QOI image", Remedy::png},
    {"gimp xcf"sv, 0, "a GIMP image (XCF)", Remedy::png},
    {"SDPX"sv, 0, "a DPX image", Remedy::exr},
    {"XPDS"sv, 0, "a DPX image", Remedy::exr},
    {"\x80\x2a\x5f\xd7"sv, 0, "a Cineon image", Remedy::exr},
    {"FORM"sv, 0, "an IFF image", Remedy::png},
    {"\x01\xda"sv, 0, "an SGI image (RGB)", Remedy::png},
    {"\x59\xa6\x6a\x95"sv, 0, "a Sun raster image", Remedy::png},
    {"SIMPLE  ="sv, 0, "a FITS image", Remedy::exr},
    {"\0\0\1\0"sv, 0, "an icon (ICO)", Remedy::png},
    {"icns"sv, 0, "an icon (ICNS)", Remedy::png},
    {"\x53\x80\xf6\x34"sv, 0, "a Softimage picture (PIC)", Remedy::png},
    {"\xb1\x68\xde\x3a"sv, 0, "a PCX document (DCX)", Remedy::png},
    {"\x11\xaf"sv, 4, "a FLI animation", Remedy::png},
    {"\x12\xaf"sv, 4, "a FLC animation", Remedy::png},
    {"FTEX"sv, 0, "an FTEX texture", Remedy::png},
    {"BLP"sv, 0, "a BLP texture", Remedy::png},
    {"VTF\0"sv, 0, "a Valve texture (VTF)", Remedy::png},
    {"PVR\3"sv, 0, "a PVR texture", Remedy::png},
    {"\x13\xab\xa1\x5c"sv, 0, "an ASTC texture", Remedy::png},
    {"%PDF"sv, 0, "a PDF document", Remedy::svg},
    {"%!PS"sv, 0, "a PostScript document", Remedy::svg},
    {"/* XPM"sv, 0, "an XPM image", Remedy::png},
    {"#define "sv, 0, "an XBM image", Remedy::png},
    {"PK\3\4"sv, 0, "a ZIP archive (or a Krita image)", Remedy::archive},
    {"\x1f\x8b"sv, 0, "compressed by gzip", Remedy::archive},
    {"\x28\xb5\x2f\xfd"sv, 0, "compressed by zstd", Remedy::archive},
    {"\xfd\x37zXZ"sv, 0, "compressed by xz", Remedy::archive},
    {"7z\xbc\xaf"sv, 0, "a 7z archive", Remedy::archive},
    {"version https://git-lfs"sv, 0, "a pointer of Git LFS instead of the image", Remedy::lfs},
};

const char* text_of(Remedy remedy) {
    switch (remedy) {
        case Remedy::png: return "convert it to PNG, for example by ImageMagick: magick FILE FILE.png";
        case Remedy::exr:
            return "convert it to PNG or, if it has more than 16 bits, to EXR, for example by ImageMagick: "
                   "magick FILE FILE.png";
        case Remedy::ktx: return "convert it to PNG, for example by KTX-Software: ktx extract FILE FILE.png";
        case Remedy::svg: return "export it as PNG, for example by Inkscape";
        case Remedy::archive: return "unpack it";
        case Remedy::download: return "download the image again: this is the page of an error";
        case Remedy::lfs: return "fetch it by git lfs pull";
    }
    return "";
}

/// P1 to P7 and a blank: bitmaps of Netpbm, of which claray reads only PFM.
bool is_netpbm(std::string_view bytes) {
    return bytes.size() > 3 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '7' &&
           " \t\r\n#"sv.find(bytes[2]) != std::string_view::npos;
}

/// A manufacturer, a version up to 5, runs, and 1 to 8 bits.
bool is_pcx(std::string_view bytes) {
    return bytes.size() > 3 && bytes[0] == 10 && bytes[1] >= 0 && bytes[1] <= 5 && bytes[2] == 1 &&
           "\1\2\4\10"sv.find(bytes[3]) != std::string_view::npos;
}

/// A cursor, which an uncompressed TGA resembles but for the number of cursors.
bool is_cursor(std::string_view bytes) {
    return bytes.size() > 5 && bytes.starts_with("\0\0\2\0"sv) && bytes[4] != 0 && bytes[5] == 0;
}

/// Markup: whether its beginning names a tag.
bool names(std::string_view bytes, std::string_view tag) {
    constexpr std::size_t beginning = 512;
    const std::string text = lower_case(bytes.substr(0, beginning));
    const std::size_t first = text.find_first_not_of("\xef\xbb\xbf \t\r\n");
    return first != std::string::npos && text[first] == '<' && text.find(tag) != std::string::npos;
}

}  // namespace

OtherFormat other_format_of(std::string_view bytes) {
    for (const ImageSignature& s : image_signatures)
        if (bytes.size() >= s.at + s.bytes.size() && bytes.substr(s.at, s.bytes.size()) == s.bytes)
            return {s.name, text_of(s.remedy)};
    if (is_netpbm(bytes)) return {"a Netpbm image (PBM, PGM, PPM or PAM)", text_of(Remedy::png)};
    if (is_pcx(bytes)) return {"a PCX image", text_of(Remedy::png)};
    if (is_cursor(bytes)) return {"a cursor (CUR)", text_of(Remedy::png)};
    if (names(bytes, "<svg")) return {"an SVG drawing", text_of(Remedy::svg)};
    if (names(bytes, "<html") || names(bytes, "<!doctype html")) return {"a web page", text_of(Remedy::download)};
    return {};
}

}  // namespace claray
