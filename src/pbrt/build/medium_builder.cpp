#include "pbrt/build/medium_builder.h"

#include "pbrt/build/collect.h"
#include "pbrt/media/medium_factory.h"

namespace pbrt {

BuiltMedia MakeMedia(SceneDescription &d, const Transform &renderFromWorld, DiagnosticSink &sink) {
    BuiltMedia built;
    for (MediumEntity &m : d.media)
        Collect(sink, [&] {
            // Rendering space is available here regardless of file order. Stock pbrt-v4 misplaces grids defined before
            // Camera.
            const Transform renderFromMedium = renderFromWorld * m.ctm.start;
            auto medium = Media().Make(m.type, m.params, MediumContext{renderFromMedium, SpaceOf(m), d.files, sink});
            built.ids.emplace(m.name, MediumId(built.media.size()));
            built.media.push_back(std::move(medium));
            m.params = {};
        });
    return built;
}

}  // namespace pbrt
