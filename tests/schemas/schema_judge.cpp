// SPDX-License-Identifier: Apache-2.0
#include "tests/schemas/schema_judge.hpp"

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "tagsmith/base/file.hpp"

namespace tagsmith::detail::test {
namespace {

using Json = nlohmann::json;

void collect_undescribed(const Json& schema, const std::string& where,
                         std::vector<std::string>& undescribed) {
  if (schema.contains("properties")) {
    for (const auto& [key, value] : schema["properties"].items()) {
      const bool refines = !schema.contains("additionalProperties");
      if (!refines && !value.contains("description")) undescribed.push_back(where + "." + key);
      collect_undescribed(value, where + "." + key, undescribed);
    }
  }
  for (const char* part : {"items", "additionalProperties"}) {
    if (schema.contains(part) && schema[part].is_object()) {
      collect_undescribed(schema[part], where + "[]", undescribed);
    }
  }
  for (const char* part : {"oneOf", "anyOf", "allOf"}) {
    if (!schema.contains(part)) continue;
    for (const Json& choice : schema[part]) collect_undescribed(choice, where, undescribed);
  }
}

}  // namespace

struct SchemaJudge::Schema {
  valijson::Schema schema;
};

nlohmann::json schema_json(const std::string& name) {
  return Json::parse(read_file("docs/schemas/" + name + ".schema.json").value());
}

SchemaJudge::SchemaJudge(const Json& schema) : schema_(std::make_unique<Schema>()) {
  valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), schema_->schema);
}

SchemaJudge::~SchemaJudge() = default;

bool SchemaJudge::accepts(const Json& document) {
  valijson::Validator validator;
  return validator.validate(schema_->schema, valijson::adapters::NlohmannJsonAdapter(document),
                            nullptr);
}

std::string SchemaJudge::objections(const Json& document) {
  valijson::Validator validator;
  valijson::ValidationResults results;
  validator.validate(schema_->schema, valijson::adapters::NlohmannJsonAdapter(document), &results);
  std::string text;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    for (const std::string& part : error.context) text += part;
    text += ": " + error.description + "\n";
  }
  return text;
}

std::vector<std::string> undescribed_keys(const Json& schema) {
  std::vector<std::string> undescribed;
  collect_undescribed(schema, "", undescribed);
  return undescribed;
}

}  // namespace tagsmith::detail::test
