MODULE trb_service
  ! A task of its own (semistatic, no motion): answers on TCP 5001 while a move blocks the program. 3 position, 4 joints,
  ! 90 state, 91 stop, 92 release. Without it nobody could stop a move before its end.
  VAR socketdev trb_server;
  VAR socketdev trb_client;
  VAR string trb_rest := "";
  ! Shared with trb_program.mod. An error that the program does not meet itself (air lost, door open): set TRB_ERROR and
  ! TRB_ERROR_TEXT "CAPABILITY%20SEVERITY%20TEXT" here, and 0 when it is over.
  PERS bool TRB_STOP;
  PERS bool TRB_STOPPED;
  PERS bool TRB_MOVING;
  PERS num TRB_ERROR;
  PERS string TRB_ERROR_TEXT;

  PROC main()
    VAR string part;
    VAR num at;
    trb_connect;
    WHILE TRUE DO
      SocketReceive trb_client \Str:=part \Time:=WAIT_MAX;
      trb_rest := trb_rest + part;
      at := StrFind(trb_rest, 1, "#");
      ! Several requests may lie in one string: a stop does not wait for an answer.
      WHILE at <= StrLen(trb_rest) DO
        trb_serve StrPart(trb_rest, 1, at - 1);
        IF at < StrLen(trb_rest) THEN
          trb_rest := StrPart(trb_rest, at + 1, StrLen(trb_rest) - at);
        ELSE
          trb_rest := "";
        ENDIF
        at := StrFind(trb_rest, 1, "#");
      ENDWHILE
    ENDWHILE
  ERROR
    IF ERRNO = ERR_SOCK_CLOSED THEN
      trb_connect;
      RETRY;
    ENDIF
  ENDPROC

  PROC trb_serve(string request)
    VAR jointtarget joints;
    VAR robtarget place;
    VAR num code;
    VAR bool ok;
    ok := StrToVal(StrPart(request + " ", 1, StrFind(request + " ", 1, " ") - 1), code);
    TEST code
    CASE 3:
      place := CRobT(\TaskName:="T_ROB1");
      SocketSend trb_client \Str:="3 1 " + NumToStr(place.trans.x, 2) + " " + NumToStr(place.trans.y, 2) + " " +
                                  NumToStr(place.trans.z, 2) + "#";
    CASE 4:
      joints := CJointT(\TaskName:="T_ROB1");
      SocketSend trb_client \Str:="4 1 " + NumToStr(joints.robax.rax_1, 2) + " " + NumToStr(joints.robax.rax_2, 2) + " " +
                                  NumToStr(joints.robax.rax_3, 2) + " " + NumToStr(joints.robax.rax_4, 2) + " " +
                                  NumToStr(joints.robax.rax_5, 2) + " " + NumToStr(joints.robax.rax_6, 2) + "#";
    CASE 90:
      SocketSend trb_client \Str:="90 1 " + trb_flag(TRB_STOP) + " " + trb_flag(TRB_MOVING) + " " +
                                  trb_flag(DOutput(doTrbMotorsOn) = 1) + " " + NumToStr(TRB_ERROR, 0);
      IF TRB_ERROR_TEXT <> "" SocketSend trb_client \Str:=" " + TRB_ERROR_TEXT;
      SocketSend trb_client \Str:="#";
    CASE 91:
      TRB_STOPPED := NOT TRB_MOVING;
      TRB_STOP := TRUE;
      WaitUntil TRB_STOPPED \MaxTime:=1 \TimeFlag:=ok;
      SocketSend trb_client \Str:="91 " + trb_flag(NOT ok) + "#";
    CASE 92:
      TRB_STOP := FALSE;
      TRB_STOPPED := FALSE;
      SocketSend trb_client \Str:="92 1#";
    DEFAULT:
      SocketSend trb_client \Str:=NumToStr(code, 0) + " 0 unknown%20request#";
    ENDTEST
  ENDPROC

  FUNC string trb_flag(bool flag)
    IF flag RETURN "1";
    RETURN "0";
  ENDFUNC

  PROC trb_connect()
    SocketClose trb_client;
    SocketClose trb_server;
    trb_rest := "";
    SocketCreate trb_server;
    SocketBind trb_server, GetSysInfo(\LanIp), 5001;
    SocketListen trb_server;
    SocketAccept trb_server, trb_client \Time:=WAIT_MAX;
  ENDPROC
ENDMODULE
