#include "simulation/hover/hover_world.hpp"

#include <utility>

#include "simulation/hover/hover_streams.hpp"
#include "simulation/scene/scenes.hpp"

namespace stillkite {

HoverWorld make_hover_world(const HoverConfig& config, VideoLink link) {
  const std::uint64_t seed =
      hover_random(static_cast<std::uint64_t>(config.seed), HoverStream::scene).bits();
  return {config.scene == SceneKind::room ? make_room(seed) : make_coast(seed),
          PatchRenderer(config.plant.camera.lens(), config.plant.camera.supersampling),
          std::move(link)};
}

}  // namespace stillkite
