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
  hall.svg        of a cloud node: the walls on the page's map, drawn in metres
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

  1. on the node:            trb node new NODE_DIR; for a cloud node with --cloud NAME
  2. where the authority is: trb fleet invite FLEET_DIR NAME --via NODE_DIR_THERE   (prints a code, and waits)
  3. on the node:            trb node join NODE_DIR (asks for the code), then trb up NODE_DIR, trb robot try NAME

Without a cloud node that is up, as for the first one: trb fleet request NODE_DIR, trb fleet sign FLEET_DIR request.json,
put certificate.json into NODE_DIR/keys.

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

  name, description   for people
  repeat              all tasks so often, round by round: 1 to 1000; 1000 tasks in all at most
  tasks               each with

  id                  a lower-case letter, then letters, digits, '_', '-'
  robot               who does it; or
  requires            ["carry"]: anybody who has these capabilities and the skill, chosen when the task is due
  skill, data         of the robot's description: {"place": "dock"}; {"from": "find", "value": "place"} in the place of a
                      value takes it out of the result of the task 'find', which must stand in "after"
  after               the tasks that must be final before; side by side if it is the same, a join if there are several
  when                {"sensor": "temperature", "of": "conveyor", "op": ">", "value": 20, "unit": "degC"}: SKIPPED unless it
                      holds, read once when the task could start. Without "of" any node's; "identity" follows a serial number
  timeout_s           for one attempt; left out: the skill's own
  retries             how often its robot tries again after it said 'failed' (0 to 16), after
  retry_after_s       0.1 to 3600, doubled each time, up to 60 s
  start_within_s      0.1 to 86400: once it is due; not begun by then it has failed
  on_failure          resilience (if left out): the run waits and the fleet looks for another robot; skip: SKIPPED, and what
                      waits for it alone too; continue: SKIPPED, and what follows goes on; abort: the run ends
  pinned              true: never given to another robot; when it fails: --retry, --skip or --abort

  trb scenario check FILE               every fault, with a node also who could not do it now and who has no spare
  trb scenario run FILE --priority 5    of two runs that want a robot the higher one begins (0 to 9)
  trb run list --all, trb run show RUN  also what is over

A task is SKIPPED if its condition is false or all before it were SKIPPED. The run goes from robot to robot; the computer
that submitted it may be switched off.
Task states: WAITING INITIALIZING RUNNING PAUSED RETRIABLE FINISHED FAILED SKIPPED.
'interrupted' means: nobody knows whether it was done. It is never repeated silently.
)"},
    {"modes",
     R"(Three modes reach any robot (profile.json):

  interpreter  messages field by field over TCP_PORT, to functions of a program on the robot
  direct       commands.json translates into the maker's own words
  ros          ROS 1 topics of any type

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
  trb doctor PEER         the same for one peer, by id or by HOST:PORT; also one that is not known
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
  out_of_use        a fault that stands, or a person, keeps it out of use: trb robot list, trb robot repaired, trb robot return
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
  for (const std::string& name : topic_names()) out += " " + name;
  return out + "\n";
}

std::vector<std::string> topic_names() {
  std::vector<std::string> out;
  for (const auto& [name, text] : kTopics) out.push_back(name);
  out.emplace_back("rights");
  return out;
}

}  // namespace trb::cli
