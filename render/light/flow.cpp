#include "render/light/flow.h"

#include <string>
#include <vector>

namespace gladstone {
namespace {

template <class... Kinds>
std::vector<std::string> kind_words(FlowKinds<Kinds...>) {
  return {Kinds::kind...};
}

/// Reads the kind of that name. @pre it is one of them
template <class... Kinds>
void read_kind(FlowKinds<Kinds...>, std::string const& word, SetupTable& table, Flow& flow) {
  auto const read = [&]<class Kind>(Kind const*) {
    if (word == Kind::kind) flow.kind = Kind::read(table);
  };
  (read(static_cast<Kinds const*>(nullptr)), ...);
}

}  // namespace

FlowSetup read_flow_setup(SetupTable table) {
  FlowSetup setup;
  std::string const word = table.kind_word("kind", UniformFlow::kind, kind_words(AllFlows{}));
  read_kind(AllFlows{}, word, table, setup.flow);
  Vec3d const fallback = word == UniformFlow::kind ? Vec3d{10, 0, 0} : Vec3d{};
  setup.flow.uniform = read_vector(table, "velocity_m_s", fallback, 1.0, {-1e9, 1e9});
  setup.dt = table.number("dt_us", 10.0, Range::positive(1e12)) * unit::microsecond;
  return setup;
}

}  // namespace gladstone
