#include "pbrt/scenefile/parameter_reader.h"

#include <utf8proc.h>

#include <cstdlib>
#include <memory>

namespace pbrt {

static const utf8proc_uint8_t *BytesOf(std::string_view text) {
    return reinterpret_cast<const utf8proc_uint8_t *>(text.data());
}

std::optional<size_t> FindInvalidUtf8(std::string_view text) {
    for (size_t i = 0; i < text.size();) {
        const std::string_view rest = text.substr(i);
        utf8proc_int32_t value = 0;
        const utf8proc_ssize_t length = utf8proc_iterate(BytesOf(rest), std::ssize(rest), &value);
        if (length <= 0) return i;
        i += length;
    }
    return {};
}

std::string ComposeUtf8(std::string_view text) {
    if (std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; }))
        return std::string(text);
    utf8proc_uint8_t *bytes = nullptr;
    const utf8proc_ssize_t length =
        utf8proc_map(BytesOf(text), std::ssize(text), &bytes, utf8proc_option_t(UTF8PROC_STABLE | UTF8PROC_COMPOSE));
    const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> owner(bytes, &std::free);
    if (length < 0) return std::string(text);
    return std::string(reinterpret_cast<const char *>(bytes), length);
}

}  // namespace pbrt
