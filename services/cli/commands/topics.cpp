// The offline help topics.
#include <map>

#include "common/security/rights.hpp"
#include "services/cli/commands/command.hpp"

namespace trb::cli {
namespace {

const std::map<std::string, std::string> kTopics = {
    {"node",
     R"(A node is a computer of the fleet: one robot's PC, or the cloud. Its folder holds

  node.json       id, framework, description, the robot's address, seeds, services
  network.json    HOST_INT (interface or address), UDP_PORT, TCP_PORT_EXT, LANE_PORT, TCP_PORT
  profile.json    which mode reaches which framework
  commands.json   which of the vendor's words belong to which subtype
  places.json     named poses in the hall (metres, radians)
  keys/           secret keys (0600) and the certificate
  state/, log/    written by the services

  trb check DIR   tells every fault of these files; trb up DIR starts the node

A service of your own: "own_services": {"fault-tally": "/opt/hall/bin/fault-tally"} in node.json; trb up starts it as
PROGRAM NODE_DIR. How it is written: common/service/README.md.

A container for each service: "bus": "tcp://ADDRESS:PORT" in node.json; keys/bus/ then proves who is who, see
services/router/README.md.
)"},
    {"fleet",
     R"(A fleet is what one authority's key has signed. To add a node:

  1. on the node:            trb fleet request NODE_DIR
  2. where the authority is: trb fleet sign FLEET_DIR request.json
  3. on the node:            put certificate.json into NODE_DIR/keys, then trb up NODE_DIR

The secret keys never leave the node; the authority's folder is on no node.

  trb fleet renew FLEET_DIR ID --via NODE_DIR    a new certificate, the same keys, no restart
  trb fleet revoke FLEET_DIR ID --via NODE_DIR   out within seconds: stolen, sold, replaced

Without --via, copy FLEET_DIR/news.json into the keys folder of any node that is up: it tells the others.
)"},
    {"scenario",
     R"(A scenario is a JSON file with a graph of tasks. A task is a skill with data, done by a robot, after others:

  {"name": "two-steps", "tasks": [
    {"id": "fetch", "robot": "ridgeback", "skill": "go_to", "data": {"place": "table_1"}},
    {"id": "move",  "robot": "conveyor",  "skill": "run",   "after": ["fetch"]}]}

A task may depend on a sensor of any node: "when": {"sensor": "temperature", "of": "conveyor", "op": ">", "value": 20,
"unit": "degC"}. Without "of" any node's is taken; "identity" follows a serial number. The value is read once, when the
task could start, and kept with the result; a task whose condition is false, or which follows only such, is SKIPPED.

The run goes from robot to robot; the computer that submitted it may be switched off.
Task states: WAITING INITIALIZING RUNNING PAUSED RETRIABLE FINISHED FAILED SKIPPED.
'interrupted' means: nobody knows whether it was done. It is never repeated silently.
)"},
    {"modes",
     R"(Three modes reach any robot (profile.json):

  interpreter  messages field by field over TCP_PORT, for robots that parse no strings
  direct       the vendor's own commands from commands.json
  ros          ROS topics (not in this version)

A subtype that commands.json does not know falls back to fields; that needs a robot connected on TCP_PORT.
`stop` never falls back.
)"},
    {"stop",
     R"(trb stop ROBOT ... | --all stops robots and fences them: nothing is commanded until trb release.
For each robot it tells

  confirmed    the robot said that it stands
  sent         its node has fenced it, but the robot did not confirm in time
  unreachable  its node was not reached

A software stop is not a safety function (ISO 13850, ISO 10218). Use the emergency stop of the machine.
)"},
    {"trouble",
     R"(When nodes do not find each other, or a robot does not obey:

  trb doctor              looks at this node and all its peers, names what is wrong and the cure
  trb doctor PEER         the same for one peer, by id or by HOST:PORT; also one that was never heard of
  trb service counters router   what was refused at the door, each reason under a name of its own
  trb logs NODE_DIR router      the same with times
)"},
    {"proof",
     R"(A router keeps what came by its links, with the seals over it, in NODE_DIR/log/proof: 64 MB, a share for each peer
(node.json: "proof_log_mb", 0 keeps none). A third party needs that folder and the fleet's public key, fleet.json:

  trb proof nodes/ur3/log/proof --fleet fleet.json

  proven         its sender's identity key has signed for it: the sender cannot deny it, the keeper cannot invent it
  authenticated  encryption proved it to the node that kept it, and to nobody else: no seal came after it
  broken         its seal does not hold: it, or what lies around it, is not what was sent

BY is whose seal it is. SOURCE is what the message says itself. HEARD is the keeper's clock, "sealed" in --json the sender's.
What a keeper has left out shows as sequences that are not in the log; what it left out at the end of a link does not
show. A certificate that was revoked in the meantime still proves what it signed before: compare the times.
)"},
    {"errors",
     R"(Every error has a code, what it concerns, and a cure. Some of them:

  no_field_channel  the subtype is not in commands.json and no robot is connected on TCP_PORT
  unknown_target    no node of that name was heard: trb route list
  peer_unreachable  its link is down; peer_expired: and has been for its lease of 10 s
  no_service        the service that takes the subtype is not running: trb service list
  fenced            the robot was stopped: trb release ROBOT
  robot_offline     the robot itself is not connected to its node
)"},
};

}  // namespace

std::string topic_text(const std::string& topic) {
  if (topic == "rights")
    return "Who may what. What is not named here is refused (refused.not_permitted).\n\n" + rights_text();
  const auto at = kTopics.find(topic);
  if (at != kTopics.end()) return at->second;
  if (!topic.empty()) return {};
  std::string out = "Topics:";
  for (const auto& [name, text] : kTopics) out += " " + name;
  return out + " rights\n";
}

}  // namespace trb::cli
