#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

/// Container of the RGL material database: named arrays in one little-endian file.
class TensorFile {
  public:
    struct Field {
        std::string name;
        std::vector<size_t> shape;
        std::vector<Float> values;  ///< empty if the type is not float32 (others are unused)
    };
    /// Throws UserError (no location).
    static TensorFile Read(const std::string &path);
    /// Throws UserError if the field is missing, not float32, or of another dimension count.
    const Field &Get(const std::string &name, size_t dimensions) const;

  private:
    std::string path_;
    std::vector<Field> fields_;
};

}  // namespace pbrt
