MODULE FieldClient
! A robot's end of the field channel (proto/FIELD_CHANNEL.md) in RAPID: framing "newline", encoding "text", "chunk_bytes": 80.
! It has not been run on a controller. Try it, and what you make of it, with
!   trb robot conform my-robot.json --large 1000 --run wave
!
! Needs the options PC Interface (616-1) for the sockets and Multitasking (623-1): this module is a task of its own
! ("TrbComm", semi static, no motion task), because a move blocks its task and a stop must get through. The motion task
! has field_client_motion.mod. The PERS variables below are declared alike in both.
!
! A RAPID string holds 80 characters, so a field does: data is an array of chunks, as they came. In them '\\' stands for a
! backslash, '\n' for a line end; they count once in the size.

CONST string TRB_NODE := "192.168.1.10";
CONST num TRB_PORT := 40000;
CONST num TRB_MOST_CHUNKS := 20;

! To the motion task, and back.
PERS string trb_order := "";       ! the skill to be done; "" : none
PERS string trb_order_data := "";
PERS string trb_report := "";      ! "done" or "failed", once it has ended
PERS bool trb_stopped := FALSE;    ! from a stop to its release; it outlasts a connection

VAR socketdev trb_socket;
VAR bool trb_connected := FALSE;
VAR string trb_held := "";         ! of the line that comes

! The message that came last.
VAR string trb_type := "";
VAR string trb_subtype := "";
VAR string trb_peer := "";
VAR num trb_size := 0;
VAR string trb_chunk{20};
VAR num trb_chunks := 0;

VAR num trb_fields := 0;           ! of the message so far
VAR num trb_got := 0;              ! bytes of its data so far

! ---- the example's loop: put your own requests and skills where it says "yours"

PROC main()
  WHILE TRUE DO
    IF NOT trb_connected TrbDial;
    IF TrbReceive(0.05) TakeMessage;
    IF trb_report <> "" THEN
      TrbReport trb_report, trb_order, "";
      trb_order := "";
      trb_report := "";
    ENDIF
  ENDWHILE
ENDPROC

PROC TakeMessage()
  IF trb_type = "command" THEN
    IF trb_subtype <> "wave" THEN                               ! yours
      TrbReport "failed", trb_subtype, "unknown";
    ELSEIF trb_stopped THEN
      TrbReport "failed", trb_subtype, "stopped";
    ELSEIF trb_order <> "" THEN
      TrbReport "failed", trb_subtype, "busy";
    ELSE
      trb_order_data := trb_chunk{1};
      trb_order := trb_subtype;                                 ! the motion task begins
    ENDIF
  ELSEIF trb_type = "request" THEN
    IF trb_subtype = "echo" THEN
      TrbSend "information", trb_subtype, trb_peer, trb_size;   ! the chunks as they came
    ELSE
      trb_chunk{1} := "unknown";                                ! yours
      trb_chunks := 1;
      TrbSend "information", trb_subtype, trb_peer, StrLen(trb_chunk{1});
    ENDIF
  ENDIF
ENDPROC

! ---- the channel

! Connects to the node; trb_connected tells whether.
PROC TrbDial()
  SocketClose trb_socket;
  SocketCreate trb_socket;
  SocketConnect trb_socket, TRB_NODE, TRB_PORT \Time:=2;
  trb_held := "";
  trb_fields := 0;                   ! a new connection begins with a new message
  trb_connected := TRUE;
ERROR
  ! The node is not there: main tries again.
  trb_connected := FALSE;
  WaitTime 0.2;
  RETURN;
ENDPROC

! TRUE if a message is whole; FALSE if none came in that time. Each field is acknowledged.
FUNC bool TrbReceive(num wait)
  VAR string field;
  WHILE TrbField(field, wait) DO
    IF field = "!stop" OR field = "!release" THEN
      trb_fields := 0;               ! what is held of a message is thrown away
      trb_stopped := field = "!stop";
      IF trb_stopped THEN
        StopMove \Quick \AllMotionTasks;
        trb_order := "";
        trb_report := "";
        TrbWrite "!stopped";
      ELSE
        TrbWrite "!released";
      ENDIF
    ELSEIF TrbTake(field) THEN
      RETURN TRUE;
    ENDIF
  ENDWHILE
  RETURN FALSE;
ENDFUNC

! One field of a message. TRUE if it is the last.
FUNC bool TrbTake(string field)
  VAR bool good;
  trb_fields := trb_fields + 1;
  TEST trb_fields
  CASE 1: trb_type := field;
  CASE 2: trb_subtype := field;
  CASE 3: trb_peer := field;
  CASE 4:
    good := StrToVal(field, trb_size);
    trb_got := 0;
    trb_chunks := 0;
  DEFAULT:
    trb_got := trb_got + TrbSizeOf(field);
    IF trb_chunks < TRB_MOST_CHUNKS THEN
      trb_chunks := trb_chunks + 1;
      trb_chunk{trb_chunks} := field;
    ENDIF
  ENDTEST
  TrbWrite "ok";
  IF trb_fields < 5 OR trb_got < trb_size RETURN FALSE;
  trb_fields := 0;
  RETURN TRUE;
ENDFUNC

! Sends a message: the chunks of trb_chunk as they are (escaped), whose unescaped size is `size`.
PROC TrbSend(string type, string subtype, string target, num size)
  TrbWrite type;
  TrbWrite subtype;
  TrbWrite target;
  TrbWrite NumToStr(size, 0);
  IF trb_chunks = 0 TrbWrite "";     ! empty data is one empty chunk
  FOR i FROM 1 TO trb_chunks DO
    TrbWrite trb_chunk{i};
  ENDFOR
ENDPROC

! Tells the own node: "done" or "failed", the skill, and why.
PROC TrbReport(string what, string skill, string reason)
  trb_chunk{1} := skill;
  IF reason <> "" trb_chunk{1} := skill + " " + reason;
  trb_chunks := 1;
  TrbSend "information", what, "", StrLen(trb_chunk{1});
ENDPROC

! The bytes that a chunk stands for: an escape counts once.
FUNC num TrbSizeOf(string field)
  VAR num size := 0;
  VAR num at := 1;
  WHILE at <= StrLen(field) DO
    IF StrPart(field, at, 1) = "\\" at := at + 1;
    at := at + 1;
    size := size + 1;
  ENDWHILE
  RETURN size;
ENDFUNC

PROC TrbWrite(string field)
  IF NOT trb_connected RETURN;
  ! Two writes: a field of 80 characters has no room for its line end.
  IF StrLen(field) > 0 SocketSend trb_socket \Str:=field;
  SocketSend trb_socket \Str:="\0A";
ERROR
  trb_connected := FALSE;
  RETURN;
ENDPROC

! A line, without its end. FALSE if none came in that time.
FUNC bool TrbField(INOUT string field, num wait)
  VAR string byte;
  WHILE trb_connected DO
    SocketReceive trb_socket \Str:=byte \ReadNoOfBytes:=1 \Time:=wait;
    IF byte = "\0A" THEN
      field := trb_held;
      trb_held := "";
      RETURN TRUE;
    ENDIF
    IF StrLen(trb_held) = 80 THEN
      trb_connected := FALSE;        ! longer than chunk_bytes says
    ELSE
      trb_held := trb_held + byte;
    ENDIF
  ENDWHILE
  RETURN FALSE;
ERROR
  ! A line that is not whole yet waits in trb_held.
  IF ERRNO <> ERR_SOCK_TIMEOUT trb_connected := FALSE;
  RETURN FALSE;
ENDFUNC
ENDMODULE
