#include "pbrt/materials/tensor_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"

namespace pbrt {

namespace {

static_assert(std::endian::native == std::endian::little);

class Bytes {
  public:
    Bytes(const std::string &data, const std::string &path) : data_(data), path_(path) {}
    template <class T>
    T Next() {
        T value;
        std::memcpy(&value, Take(sizeof(T)), sizeof(T));
        return value;
    }
    std::string Text(size_t length) { return {Take(length), length}; }
    /// `count` floats at `offset`, without moving the position.
    std::vector<Float> FloatsAt(uint64_t offset, uint64_t count) const {
        if (offset > data_.size() || count > (data_.size() - offset) / sizeof(float)) Fail("is cut off");
        std::vector<Float> values(count);
        if (count) std::memcpy(values.data(), data_.data() + offset, count * sizeof(float));
        return values;
    }
    uint64_t Size() const { return data_.size(); }
    [[noreturn]] void Fail(const char *why) const { throw UserError(fmt::format("{}: tensor file {}.", path_, why)); }

  private:
    const char *Take(size_t n) {
        if (n > data_.size() - at_) Fail("is cut off");
        at_ += n;
        return data_.data() + at_ - n;
    }
    const std::string &data_;
    const std::string &path_;
    size_t at_ = 0;
};

constexpr uint8_t kFloat32 = 10;

}  // namespace

TensorFile TensorFile::Read(const std::string &path) {
    const std::string data = ReadFileContents(path);
    Bytes bytes(data, path);
    if (data.size() < 18 || bytes.Text(12) != std::string("tensor_file\0", 12)) bytes.Fail("header is missing");
    const int major = bytes.Next<uint8_t>(), minor = bytes.Next<uint8_t>();
    if (major != 1 || minor != 0) bytes.Fail("has an unknown version (1.0 is known)");
    TensorFile file;
    file.path_ = path;
    const uint32_t count = bytes.Next<uint32_t>();
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; ++i) {
        Field field;
        field.name = bytes.Text(bytes.Next<uint16_t>());
        const size_t dimensions = bytes.Next<uint16_t>();
        const uint8_t type = bytes.Next<uint8_t>();
        const uint64_t offset = bytes.Next<uint64_t>();
        uint64_t size = 1;
        for (size_t d = 0; d < dimensions; ++d) {
            const uint64_t extent = bytes.Next<uint64_t>();
            if (extent > bytes.Size() || (extent > 0 && size > bytes.Size() / extent)) bytes.Fail("is cut off");
            size *= extent;
            field.shape.push_back(extent);
        }
        if (type == kFloat32) {
            total += size;
            if (total > bytes.Size() / sizeof(float)) bytes.Fail("has fields that overlap");
            field.values = bytes.FloatsAt(offset, size);
        }
        file.fields_.push_back(std::move(field));
    }
    return file;
}

const TensorFile::Field &TensorFile::Get(const std::string &name, size_t dimensions) const {
    for (const Field &field : fields_) {
        if (field.name != name) continue;
        if (field.shape.size() != dimensions || field.values.empty())
            throw UserError(
                fmt::format("{}: field \"{}\" must be 32 bit floats in {} dimensions.", path_, name, dimensions));
        for (size_t i = 0; i < field.values.size(); ++i)
            if (!std::isfinite(field.values[i]))
                throw UserError(fmt::format("{}: field \"{}\": value {} is {}; all must be finite.", path_, name, i,
                                            field.values[i]));
        return field;
    }
    throw UserError(fmt::format("{}: field \"{}\" is missing.", path_, name));
}

}  // namespace pbrt
