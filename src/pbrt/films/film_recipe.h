#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "pbrt/films/film.h"

namespace pbrt {

/// All that the picture of a film depends on beside its sums, so that the picture can be made where the scene is not.
struct FilmRecipe {
    std::string type;
    ParamSet params;
    std::string colorSpace = "srgb";
    Float exposureTime = 1;  ///< seconds
    FilmOverrides overrides;

    /// An empty film. It makes the same picture of the same sums as that of the scene; samples cannot be added to it.
    std::unique_ptr<Film> Make() const;
    nlohmann::ordered_json ToJson() const;
    /// Throws UserError or an exception of the JSON library for what ToJson did not make.
    static FilmRecipe FromJson(const nlohmann::ordered_json &json);
};

/// Floats as their bits, because JSON has neither all of their digits nor infinity.
nlohmann::ordered_json ToJson(const ImageMetadata &metadata);
/// Attributes only.
ImageMetadata MetadataFromJson(const nlohmann::ordered_json &json);

}  // namespace pbrt
