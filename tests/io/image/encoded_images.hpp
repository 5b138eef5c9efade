// Small image files from other programs' encoders (zlib by way of Python; stb_image_write for the JPEG), as base64.
#pragma once

namespace claray::test {

/// 2x2 RGBA: (255, 0, 0, 255) (0, 255, 0, 128) / (0, 0, 255, 0) (10, 20, 30, 40).
inline constexpr const char* png_rgba =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFklEQVR42mP4z8DwHwgbGEA0l4icBgA2qQThZNtNfgAAAABJRU5ErkJggg==";
/// 2x1 grey of 16 bits: 0, 0x8001.
inline constexpr const char* png_grey16 =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAAAAACB2fwVAAAADUlEQVR42mNgYGhgBAABBgCC/JcFVQAAAABJRU5ErkJggg==";
/// 2x1 by palette: (200, 100, 50, 255) (9, 8, 7, 77).
inline constexpr const char* png_palette =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAMAAADD/"
    "I+4AAAABlBMVEUJCAfIZDJ5NaOkAAAAAXRSTlNNSIvlSwAAAAtJREFUeNpjYGQAAAAFAAJCwkSf"
    "AAAAAElFTkSuQmCC";
/// 2x1 RGB (1, 2, 3) (4, 5, 6), of which the first colour is transparent.
inline constexpr const char* png_key =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAABnRSTlMAAQACAAPJS6v1AAAAD0lEQVR42mNgZGJmYWUDAAA/"
    "ABaYwWgTAAAAAElFTkSu"
    "QmCC";
/// 8x8 RGB, all (200, 100, 50), quality 50.
inline constexpr const char* jpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wCEABALDA4MChAODQ4SERATGCgaGBYWGDEjJR0oOjM9PDkzODdASFxOQERXRTc4UG1RV19iZ2hnPk1xeXBk"
    "eFxlZ2MBERISGBUYLxoaL2NCOEJjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY//AABEIAAgACAMBIg"
    "ACEQEDEQH/xAGiAAABBQEBAQEBAQAAAAAAAAAAAQIDBAUGBwgJCgsQAAIBAwMCBAMFBQQEAAABfQECAwAEEQUSITFBBhNRYQcicRQygZGhCCNCscEV"
    "UtHwJDNicoIJChYXGBkaJSYnKCkqNDU2Nzg5OkNERUZHSElKU1RVVldYWVpjZGVmZ2hpanN0dXZ3eHl6g4SFhoeIiYqSk5SVlpeYmZqio6Slpqeoqa"
    "qy"
    "s7S1tre4ubrCw8TFxsfIycrS09TV1tfY2drh4uPk5ebn6Onq8fLz9PX29/"
    "j5+gEAAwEBAQEBAQEBAQAAAAAAAAECAwQFBgcICQoLEQACAQIEBAMEBwUE"
    "BAABAncAAQIDEQQFITEGEkFRB2FxEyIygQgUQpGhscEJIzNS8BVictEKFiQ04SXxFxgZGiYnKCkqNTY3ODk6Q0RFRkdISUpTVFVWV1hZWmNkZWZnaG"
    "lq"
    "c3R1dnd4eXqCg4SFhoeIiYqSk5SVlpeYmZqio6Slpqeoqaqys7S1tre4ubrCw8TFxsfIycrS09TV1tfY2dri4+Tl5ufo6ery8/T19vf4+fr/"
    "2gAMAwEA"
    "AhEDEQA/AG0UUV5Z7J//2Q==";

}  // namespace claray::test
