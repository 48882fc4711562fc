#include "project/source.hpp"

namespace bodesmith::project {

ProjectSource ProjectSource::read(const std::filesystem::path& file) {
  Provenance from;
  const Node document = read_document(file, from);
  document.expect_schema("project");
  return {file, document, std::move(from), {}};
}

bool ProjectSource::is_filter() const {
  return document.has("target") && document.at("target").kind() == Node::Kind::object &&
         !document.at("target").has("disturbance") && !document.has("track") && !document.has("plant");
}

}  // namespace bodesmith::project
