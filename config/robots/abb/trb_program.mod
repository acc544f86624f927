MODULE trb_program
  ! Task T_ROB1: takes requests "CODE PARAMETER ... #" on TCP 5000, one client, and answers "CODE OK VALUE ...#" once they
  ! are over; a move blocks until then. Yours to change: trb_carry_out. Output doTrbGripper is the gripper.
  VAR socketdev trb_server;
  VAR socketdev trb_client;
  VAR string trb_rest := "";
  VAR string trb_word{12};
  VAR num trb_words := 0;
  VAR num trb_code := 0;
  VAR string trb_text := "";
  VAR intnum trb_interrupt;
  CONST errnum TRB_GIVEN_UP := -1;
  ! Shared with trb_service.mod.
  PERS bool TRB_STOP := FALSE;
  PERS bool TRB_STOPPED := FALSE;
  PERS bool TRB_MOVING := FALSE;
  PERS num TRB_ERROR := 0;
  PERS string TRB_ERROR_TEXT := "";

  PROC main()
    BookErrNo TRB_GIVEN_UP;
    IDelete trb_interrupt;
    CONNECT trb_interrupt WITH trb_stop_trap;
    IPers TRB_STOP, trb_interrupt;
    trb_connect;
    WHILE TRUE DO
      trb_receive;
      trb_text := "";
      IF trb_carry_out() THEN
        trb_answer 1;
      ELSE
        trb_answer 0;
      ENDIF
    ENDWHILE
  ERROR (LONG_JMP_ALL_ERR)
    TRB_MOVING := FALSE;
    IF ERRNO = ERR_SOCK_CLOSED THEN
      trb_connect;
      RETRY;
    ENDIF
    ! The move that was carried out has ended badly: that is its answer.
    IF ERRNO = TRB_GIVEN_UP THEN
      trb_text := "stopped";
    ELSE
      TRB_ERROR := ERRNO;
      trb_text := "error%20" + NumToStr(ERRNO, 0);
    ENDIF
    StopMove \Quick;
    ClearPath;
    StartMove;
    trb_answer 0;
    TRYNEXT;
  ENDPROC

  ! TRUE: well. FALSE: trb_text says why not; a blank in it is %20.
  FUNC bool trb_carry_out()
    VAR jointtarget joints;
    VAR robtarget place;
    IF TRB_STOP THEN
      trb_text := "stopped";
      RETURN FALSE;
    ENDIF
    TRB_MOVING := TRUE;
    TEST trb_code
    CASE 0:
    CASE 2:
      IF trb_words <> 6 trb_text := "6%20joints%20are%20needed";
      IF trb_words = 6 THEN
        joints := CJointT();
        joints.robax := [trb_num(1), trb_num(2), trb_num(3), trb_num(4), trb_num(5), trb_num(6)];
        MoveAbsJ joints, v500, fine, tool0;
      ENDIF
    CASE 3:
      place := CRobT(\Tool:=tool0 \WObj:=wobj0);
      trb_text := NumToStr(place.trans.x, 2) + " " + NumToStr(place.trans.y, 2) + " " + NumToStr(place.trans.z, 2);
    CASE 4:
      joints := CJointT();
      trb_text := NumToStr(joints.robax.rax_1, 2) + " " + NumToStr(joints.robax.rax_2, 2) + " " +
                  NumToStr(joints.robax.rax_3, 2) + " " + NumToStr(joints.robax.rax_4, 2) + " " +
                  NumToStr(joints.robax.rax_5, 2) + " " + NumToStr(joints.robax.rax_6, 2);
      TRB_MOVING := FALSE;
      RETURN TRUE;
    CASE 10:
      IF trb_words <> 4 trb_text := "4%20numbers%20are%20needed";
      IF trb_words = 4 THEN
        place := CRobT(\Tool:=tool0 \WObj:=wobj0);
        place.trans := [trb_num(1), trb_num(2), trb_num(3)];
        place.rot := OrientZYX(trb_num(4), 0, 180);
        MoveJ place, v250, fine, tool0;
      ENDIF
    CASE 20:
      SetDO doTrbGripper, trb_num(1);
      WaitTime 0.5;
    CASE 40:
      IF trb_words > 0 TPWrite trb_word{1};
    DEFAULT:
      trb_text := "unknown%20request";
    ENDTEST
    TRB_MOVING := FALSE;
    RETURN trb_text = "" OR trb_code = 3;
  ENDFUNC

  TRAP trb_stop_trap
    IF NOT TRB_STOP RETURN;
    StopMove \Quick;
    TRB_STOPPED := TRUE;
    IF TRB_MOVING RAISE TRB_GIVEN_UP;
  ERROR
    RAISE;
  ENDTRAP

  FUNC num trb_num(num index)
    VAR num value := 0;
    VAR bool ok;
    ok := StrToVal(trb_word{index}, value);
    RETURN value;
  ENDFUNC

  PROC trb_connect()
    SocketClose trb_client;
    SocketClose trb_server;
    trb_rest := "";
    SocketCreate trb_server;
    SocketBind trb_server, GetSysInfo(\LanIp), 5000;
    SocketListen trb_server;
    SocketAccept trb_server, trb_client \Time:=WAIT_MAX;
  ENDPROC

  ! One request: up to its #. A RAPID string holds 80 characters, so the request does, too.
  PROC trb_receive()
    VAR string part;
    VAR num at;
    at := StrFind(trb_rest, 1, "#");
    WHILE at > StrLen(trb_rest) DO
      SocketReceive trb_client \Str:=part \Time:=WAIT_MAX;
      IF StrLen(trb_rest) + StrLen(part) > 80 THEN
        trb_rest := "";
      ENDIF
      trb_rest := trb_rest + part;
      at := StrFind(trb_rest, 1, "#");
    ENDWHILE
    part := StrPart(trb_rest, 1, at - 1);
    IF at < StrLen(trb_rest) THEN
      trb_rest := StrPart(trb_rest, at + 1, StrLen(trb_rest) - at);
    ELSE
      trb_rest := "";
    ENDIF
    trb_split part + " ";
  ENDPROC

  PROC trb_split(string line)
    VAR num begin := 1;
    VAR num blank;
    VAR bool ok;
    trb_words := -1;
    WHILE begin <= StrLen(line) AND trb_words < Dim(trb_word, 1) DO
      blank := StrFind(line, begin, " ");
      IF blank > begin THEN
        trb_words := trb_words + 1;
        IF trb_words = 0 THEN
          ok := StrToVal(StrPart(line, begin, blank - begin), trb_code);
        ELSE
          trb_word{trb_words} := StrPart(line, begin, blank - begin);
        ENDIF
      ENDIF
      begin := blank + 1;
    ENDWHILE
  ENDPROC

  PROC trb_answer(num ok)
    SocketSend trb_client \Str:=NumToStr(trb_code, 0) + " " + NumToStr(ok, 0);
    IF trb_text <> "" SocketSend trb_client \Str:=" " + trb_text;
    SocketSend trb_client \Str:="#";
  ENDPROC
ENDMODULE
