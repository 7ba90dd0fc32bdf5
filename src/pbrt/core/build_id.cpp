#include "pbrt/core/version.h"

#include <elf.h>
#include <link.h>

#include <cstring>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

/// The first 16 digits of the object's build id; empty if it has none.
std::string IdOf(const dl_phdr_info &object) {
    for (int i = 0; i < object.dlpi_phnum; ++i) {
        const ElfW(Phdr) &segment = object.dlpi_phdr[i];
        if (segment.p_type != PT_NOTE) continue;
        const char *at = reinterpret_cast<const char *>(object.dlpi_addr + segment.p_vaddr);
        const char *end = at + segment.p_memsz;
        while (at + sizeof(ElfW(Nhdr)) <= end) {
            ElfW(Nhdr) note;
            std::memcpy(&note, at, sizeof(note));
            const char *name = at + sizeof(note), *content = name + ((note.n_namesz + 3u) & ~3u);
            if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(name, "GNU", 4) == 0) {
                std::string digits;
                for (unsigned k = 0; k < note.n_descsz && k < 8; ++k)
                    digits += fmt::format("{:02x}", static_cast<unsigned char>(content[k]));
                return digits;
            }
            at = content + ((note.n_descsz + 3u) & ~3u);
        }
    }
    return {};
}

int Visit(dl_phdr_info *object, size_t, void *text) {
    std::string &ids = *static_cast<std::string *>(text);
    const std::string_view path(object->dlpi_name), name = path.substr(path.rfind('/') + 1);
    if (ids.empty()) {  // the program comes first
        ids = IdOf(*object);
        if (ids.empty()) ids = "unknown";
        return 0;
    }
    for (const char *library : {"libembree3.so", "libm.so"})
        if (name.starts_with(library)) ids += fmt::format(" {}:{}", name.substr(0, name.find('.')), IdOf(*object));
    return 0;
}

}  // namespace

std::string BuildId() {
    std::string ids;
    dl_iterate_phdr(Visit, &ids);
    return ids;
}

}  // namespace pbrt
