#include "pbrt/films/gbuffer_film.h"
#include "pbrt/films/spectral_film.h"

namespace pbrt {

const std::vector<std::string> &SupportedFilms() {
    static const std::vector<std::string> names = {"rgb", "gbuffer", "spectral"};
    return names;
}

std::unique_ptr<RgbFilm> MakeFilm(const std::string &type, const ParamSet &params, const ColorSpace &outputSpace,
                                  Float exposureTime, const FilmOverrides &overrides, DiagnosticSink &sink) {
    if (type == "rgb") return std::make_unique<RgbFilm>(params, outputSpace, exposureTime, overrides, sink);
    if (type == "gbuffer") return std::make_unique<GBufferFilm>(params, outputSpace, exposureTime, overrides, sink);
    if (type == "spectral") return std::make_unique<SpectralFilm>(params, outputSpace, exposureTime, overrides, sink);
    throw UserError(fmt::format("Film \"{}\" is unknown; {}.", type, ListChoices(type, SupportedFilms())),
                    params.Loc());
}

}  // namespace pbrt
