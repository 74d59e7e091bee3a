"""The terms that `kg` writes, each as N-Triples spells it (`<...>`).

`ontology/onto-ros.ttl` and `ontology/rnkg.ttl` define and explain them; a test keeps the two in step.
"""

from __future__ import annotations

from typing import Final

from kg.syntax import names

PREFIXES: Final = dict(names.PREFIXES)
"""The prefixes that queries need not declare, as the dictionary that the engine asks for."""

ROS: Final = PREFIXES["ros"]
RNKG: Final = PREFIXES["rnkg"]
RDF: Final = PREFIXES["rdf"]
RDFS: Final = PREFIXES["rdfs"]
OWL: Final = PREFIXES["owl"]
XSD: Final = PREFIXES["xsd"]
PROV: Final = PREFIXES["prov"]
DCTERMS: Final = PREFIXES["dcterms"]
SKOS: Final = PREFIXES["skos"]
SCHEMA: Final = PREFIXES["schema"]


def ros(name: str) -> str:
    """Return the term `name` of onto-ros as N-Triples spells it."""
    return f"<{ROS}{name}>"


def rnkg(name: str) -> str:
    """Return the term `name` of RNKG as N-Triples spells it."""
    return f"<{RNKG}{name}>"


def bare(term: str) -> str:
    """Return the IRI of a term without its angle brackets."""
    return term[1:-1]


TYPE: Final = f"<{RDF}type>"
LABEL: Final = f"<{RDFS}label>"
COMMENT: Final = f"<{RDFS}comment>"
DESCRIPTION: Final = f"<{DCTERMS}description>"
LICENSE: Final = f"<{DCTERMS}license>"
SOURCE_CODE: Final = f"<{SCHEMA}SoftwareSourceCode>"

ACTIVITY: Final = f"<{PROV}Activity>"
SOFTWARE_AGENT: Final = f"<{PROV}SoftwareAgent>"
STARTED: Final = f"<{PROV}startedAtTime>"
ENDED: Final = f"<{PROV}endedAtTime>"
USED: Final = f"<{PROV}used>"
GENERATED: Final = f"<{PROV}generated>"
ASSOCIATED: Final = f"<{PROV}wasAssociatedWith>"

NODE: Final = ros("Node")
PACKAGE: Final = ros("Package")
TOPIC: Final = ros("Topic")
SERVICE: Final = ros("Service")
MESSAGE: Final = ros("Message")
REQUEST: Final = ros("RequestMessage")
RESPONSE: Final = ros("ResponseMessage")
PUBLISHER: Final = ros("Publisher")
SUBSCRIBER: Final = ros("Subscriber")
SERVICE_SERVER: Final = ros("ServiceServer")
SERVICE_CLIENT: Final = ros("ServiceClient")
HAS_COMPONENT: Final = ros("hasComponent")
ROS_HAS_MESSAGE: Final = ros("hasMessage")

REPOSITORY: Final = rnkg("Repository")
RNKG_PACKAGE: Final = rnkg("Package")
PACKAGE_NAME_CLASS: Final = rnkg("PackageName")
NODE_TYPE: Final = rnkg("NodeType")
EXECUTABLE: Final = rnkg("Executable")
ACTION: Final = rnkg("Action")
ACTION_SERVER: Final = rnkg("ActionServer")
ACTION_CLIENT: Final = rnkg("ActionClient")
MESSAGE_TYPE: Final = rnkg("MessageType")
SERVICE_TYPE: Final = rnkg("ServiceType")
ACTION_TYPE: Final = rnkg("ActionType")
GOAL: Final = rnkg("GoalMessage")
RESULT: Final = rnkg("ResultMessage")
FEEDBACK: Final = rnkg("FeedbackMessage")
PARAMETER: Final = rnkg("Parameter")
DEFINITION: Final = rnkg("InterfaceDefinition")
FIELD: Final = rnkg("Field")
PERSON: Final = rnkg("Person")
DEPENDENCY: Final = rnkg("Dependency")
SOURCE_FILE: Final = rnkg("SourceFile")
PROBLEM: Final = rnkg("Problem")
BUILD: Final = rnkg("Build")
QOS: Final = rnkg("Qos")
DESCRIPTION_CLASS: Final = rnkg("Description")
PHRASE: Final = rnkg("Phrase")

CONTAINS: Final = rnkg("contains")
CONNECTS_TO: Final = rnkg("connectsTo")
HAS_MESSAGE: Final = rnkg("hasMessage")
HAS_SERVICE_TYPE: Final = rnkg("hasServiceType")
HAS_ACTION_TYPE: Final = rnkg("hasActionType")
HAS_REQUEST: Final = rnkg("hasRequest")
HAS_RESPONSE: Final = rnkg("hasResponse")
HAS_GOAL: Final = rnkg("hasGoal")
HAS_RESULT: Final = rnkg("hasResult")
HAS_FEEDBACK: Final = rnkg("hasFeedback")
HAS_PARAMETER: Final = rnkg("hasParameter")
HAS_EXECUTABLE: Final = rnkg("hasExecutable")
HAS_SOURCE: Final = rnkg("hasSource")
HAS_QOS: Final = rnkg("hasQos")
HAS_FIELD: Final = rnkg("hasField")
HAS_FIELD_TYPE: Final = rnkg("hasFieldType")
HAS_DEPENDENCY: Final = rnkg("hasDependency")
HAS_DESCRIPTION: Final = rnkg("hasDescription")
SNIPPET: Final = rnkg("Snippet")
HAS_SNIPPET: Final = rnkg("hasSnippet")
QUOTES: Final = rnkg("quotes")
QUOTED_LINES: Final = rnkg("quotedLines")
HAS_PHRASE: Final = rnkg("hasPhrase")
HAS_PROBLEM: Final = rnkg("hasProblem")
HAS_PACKAGE_NAME: Final = rnkg("hasPackageName")
DEFINES: Final = rnkg("defines")
DEPENDS_ON: Final = rnkg("dependsOn")
DECLARED_IN: Final = rnkg("declaredIn")
MAINTAINER: Final = rnkg("maintainer")
AUTHOR: Final = rnkg("author")
RESOLUTION: Final = rnkg("resolution")
KIND: Final = rnkg("kind")
ACCESS: Final = rnkg("access")
ON_PACKAGE: Final = rnkg("onPackage")

NAME: Final = rnkg("name")
RESOLVED_NAME: Final = rnkg("resolvedName")
WRITTEN: Final = rnkg("written")
LEAST_ARGUMENTS: Final = rnkg("leastArguments")
SWITCHED_BY: Final = rnkg("switchedBy")
NEVER_PUBLISHES: Final = rnkg("neverPublishes")
PUBLISHES_UPON: Final = rnkg("publishesUpon")
IGNORES_MESSAGES: Final = rnkg("ignoresMessages")
LEAVES_UNSET: Final = rnkg("leavesUnset")
SETS_PART: Final = rnkg("setsPart")
PARAMETER_NAME: Final = rnkg("parameterName")
IMPLICIT: Final = rnkg("implicit")
ORIGIN: Final = rnkg("origin")
REASON: Final = rnkg("reason")
PATH: Final = rnkg("path")
LINE: Final = rnkg("line")
IN_REPOSITORY: Final = rnkg("repository")
LANGUAGE: Final = rnkg("language")
ROS_VERSION: Final = rnkg("rosVersion")
PLUGIN_NAME: Final = rnkg("pluginName")
NODE_NAME: Final = rnkg("nodeName")
NODE_NAMESPACE: Final = rnkg("nodeNamespace")
BASE_CLASS: Final = rnkg("baseClass")
ALIAS: Final = rnkg("alias")
BOUND: Final = rnkg("bound")
EXPORTED_AT: Final = rnkg("exportedAt")
IMPORTS: Final = rnkg("imports")
IMPORTED_AT: Final = rnkg("importedAt")
PLUGIN_SLOT: Final = rnkg("PluginSlot")
HAS_PLUGIN_SLOT: Final = rnkg("hasPluginSlot")
LOADS_AS: Final = rnkg("loadsAs")
NAMES_PARAMETER: Final = rnkg("namesParameter")
CLASS_PARAMETER: Final = rnkg("classParameter")
CLASS_FIXED: Final = rnkg("classFixed")
DEFAULT_PLUGIN: Final = rnkg("DefaultPlugin")
HAS_DEFAULT_PLUGIN: Final = rnkg("hasDefaultPlugin")
CLASS_NAME: Final = rnkg("className")
RELIABILITY: Final = rnkg("reliability")
DURABILITY: Final = rnkg("durability")
HISTORY: Final = rnkg("history")
DEPTH: Final = rnkg("depth")
DEADLINE: Final = rnkg("deadline")
LIFESPAN: Final = rnkg("lifespan")
LIVELINESS: Final = rnkg("liveliness")
LEASE_DURATION: Final = rnkg("leaseDuration")
PARAMETER_TYPE: Final = rnkg("parameterType")
DEFAULT_VALUE: Final = rnkg("defaultValue")
CONSTANT_VALUE: Final = rnkg("constantValue")
SECTION: Final = rnkg("section")
REFERENCE_NODE: Final = rnkg("ReferenceNode")
REFERENCE_ENTRY: Final = rnkg("ReferenceEntry")
DESCRIBES: Final = rnkg("describes")
IN_PACKAGE: Final = rnkg("inPackage")
HAS_ENTRY: Final = rnkg("hasEntry")
FOUND_AS: Final = rnkg("foundAs")
CLOSED_ROLE: Final = rnkg("closedRole")
ROLE: Final = rnkg("role")
PLAIN_NAME: Final = rnkg("plainName")
TYPE_NAME: Final = rnkg("typeName")
POSITION: Final = rnkg("position")
FIELD_TYPE: Final = rnkg("fieldType")
DEFINITION_KIND: Final = rnkg("definitionKind")
VERSION: Final = rnkg("version")
MANIFEST_FORMAT: Final = rnkg("manifestFormat")
BUILD_TYPE: Final = rnkg("buildType")
LICENSE_NAME: Final = rnkg("licenseName")
FOLDER: Final = rnkg("folder")
DEPRECATED: Final = rnkg("deprecated")
WEBSITE: Final = rnkg("website")
CODE_REPOSITORY: Final = rnkg("codeRepository")
BUG_TRACKER: Final = rnkg("bugTracker")
EMAIL: Final = rnkg("email")
DEPENDENCY_KIND: Final = rnkg("dependencyKind")
FILE_KIND: Final = rnkg("fileKind")
BYTES: Final = rnkg("bytes")
DIGEST: Final = rnkg("digest")
CONTENT: Final = rnkg("content")
CODE: Final = rnkg("code")
TEXT: Final = rnkg("message")
DESCRIPTION_KIND: Final = rnkg("descriptionKind")
DESCRIPTION_TEXT: Final = rnkg("text")
DESCRIPTION_WORD: Final = rnkg("descriptionWord")
HEADING: Final = rnkg("heading")
TERM: Final = rnkg("term")
COMMIT: Final = rnkg("commit")
BRANCH: Final = rnkg("branch")
REMOTE: Final = rnkg("remote")
DIRTY: Final = rnkg("dirty")
ROOT: Final = rnkg("root")
KG_VERSION: Final = rnkg("kgVersion")
PACKAGES: Final = rnkg("packageCount")
NODES: Final = rnkg("nodeCount")
INTERFACES: Final = rnkg("interfaceCount")
PARAMETERS: Final = rnkg("parameterCount")
DEFINITIONS: Final = rnkg("definitionCount")
FILES: Final = rnkg("fileCount")
PROBLEMS: Final = rnkg("problemCount")
UNRESOLVED: Final = rnkg("unresolvedCount")
BOUNDED: Final = rnkg("boundedCount")
TRIPLES: Final = rnkg("tripleCount")

CONFIGURATION: Final = rnkg("LaunchConfiguration")
RUNNING_SYSTEM: Final = rnkg("RunningSystem")
ARGUMENT: Final = rnkg("LaunchArgument")
LAUNCH_PROBLEM: Final = rnkg("LaunchProblem")
INSTANCE: Final = rnkg("NodeInstance")
INSTANCE_END: Final = rnkg("InstanceEnd")
REMAP: Final = rnkg("Remap")
SETTING: Final = rnkg("ParameterSetting")

HAS_INSTANCE: Final = rnkg("hasInstance")
INSTANCE_OF: Final = rnkg("instanceOf")
HAS_ARGUMENT: Final = rnkg("hasArgument")
HAS_LAUNCH_PROBLEM: Final = rnkg("hasLaunchProblem")
STARTED_WITH: Final = rnkg("startedWith")
HAS_SETTING: Final = rnkg("hasSetting")
HAS_REMAP: Final = rnkg("hasRemap")
READS_ENTRY: Final = rnkg("readsEntry")
INCLUDES: Final = rnkg("includes")
OF_PACKAGE: Final = rnkg("ofPackage")
HOST: Final = rnkg("host")
LOADS_PLUGIN: Final = rnkg("loadsPlugin")
DECLARED_BY: Final = rnkg("declaredBy")
OVERRIDES: Final = rnkg("overrides")
WITHOUT: Final = rnkg("without")
REMAPPED_BY: Final = rnkg("remappedBy")
NAMED_BY: Final = rnkg("namedBy")
RESEMBLES: Final = rnkg("resembles")
SETS: Final = rnkg("sets")

LAUNCH_DIALECT: Final = rnkg("launchDialect")
NAMESPACE: Final = rnkg("namespace")
START_KIND: Final = rnkg("startKind")
STARTS_PACKAGE: Final = rnkg("startsPackage")
STARTS_EXECUTABLE: Final = rnkg("startsExecutable")
STARTS_PLUGIN: Final = rnkg("startsPlugin")
LOADS_LIBRARY: Final = rnkg("loadsLibrary")
START_ARGUMENT: Final = rnkg("startArgument")
START_SETTING: Final = rnkg("startSetting")
CONDITION: Final = rnkg("condition")
COMPLETE: Final = rnkg("complete")
VIA: Final = rnkg("via")
INCLUDE_CHAIN: Final = rnkg("includeChain")
FROM: Final = rnkg("from")
TO: Final = rnkg("to")
RESEMBLES_NAME: Final = rnkg("resemblesName")
KEEPS_OWN_NAME: Final = rnkg("keepsOwnName")
VALUE: Final = rnkg("value")
FIXED: Final = rnkg("fixed")
CHOICE: Final = rnkg("choice")
PROBLEM_KIND: Final = rnkg("problemKind")
SUBJECT: Final = rnkg("subject")
ORDER: Final = rnkg("order")
MISSING: Final = rnkg("missing")
ADDRESS: Final = rnkg("address")
SEEN_AT: Final = rnkg("seenAt")
SEEN_SINCE: Final = rnkg("seenSince")
SEEN_UNTIL: Final = rnkg("seenUntil")
INSTALLS: Final = rnkg("installs")
